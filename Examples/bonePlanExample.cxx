/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// A screw along the neck of a femur, from the lateral cortex into the head, and the section where the neck would be
// cut: bonePlanExample MODEL.vtu LANDMARKS.mrk.json

#include "boneFemurMeasures.h"
#include "bonePathPlan.h"
#include "boneResectionPlan.h"

#include "boneLandmarkIO.h"
#include "boneMeshIO.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 3)
  {
    std::cerr << "usage: bonePlanExample MODEL.vtu LANDMARKS.mrk.json\n";
    return EXIT_FAILURE;
  }
  try
  {
    const bone::MeshArrays    model = bone::ReadMeshArrays(argv[1]);
    std::vector<bone::IdType> ids;
    const auto                femur = bone::FitFemur(bone::ExteriorSurface(model, ids), bone::ReadLandmarks(argv[2]));
    if (!femur.neck)
    {
      std::cerr << argv[1] << ": the neck cannot be fitted: " << femur.neckReason << '\n';
      return EXIT_FAILURE;
    }
    const bone::Vector3 & axis = femur.neck->axis;
    const auto section = bone::MeasureSection(model, { femur.head->centre - femur.neck->narrowest * axis, axis });
    std::cout << "neck: area " << section.shape.area << " mm^2, second moments " << section.shape.largest << " and "
              << section.shape.smallest << " mm^4\n";

    const bone::PathPlanner  planner(model);
    bone::PathPlanParameters parameters;
    parameters.margin = 3.0; // mm
    // From beyond the lateral cortex to 8 mm below the head's surface.
    const bone::Capsule start{ femur.head->centre - 95.0 * axis,
                               femur.head->centre + (femur.head->radius - 8.0 - 3.25) * axis,
                               3.25 };
    bone::Capsule       best;
    if (!planner.Search(start, parameters, best))
    {
      std::cout << "no safe path near the neck's axis\n";
      return EXIT_SUCCESS;
    }
    for (const bone::Capsule & path : { start, best })
    {
      const auto found = planner.Assess(path, parameters.margin, parameters.shell);
      std::cout << "path to " << path.to.transpose() << ": mean density around it " << found.MeanAround()
                << ", median in it " << bone::Percentile(found.along, 0.5) << ", least clearance "
                << found.leastClearance << " mm\n";
    }
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
