/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// Landmarks of a standard model carried to a subject of the same topology, and the subject's measures with the density
// in the middle of its femoral head: boneMeasurementExample STANDARD.vtu LANDMARKS.mrk.json SUBJECT.vtu

#include "boneFemurMeasures.h"
#include "boneMeasureReport.h"

#include "boneLandmarkIO.h"
#include "boneMeshIO.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 4)
  {
    std::cerr << "usage: boneMeasurementExample STANDARD.vtu LANDMARKS.mrk.json SUBJECT.vtu\n";
    return EXIT_FAILURE;
  }
  try
  {
    const bone::MeshArrays subject = bone::ReadMeshArrays(argv[3]);
    const auto landmarks = bone::CarryLandmarks(bone::ReadMeshArrays(argv[1]), bone::ReadLandmarks(argv[2]), subject);
    const auto report = bone::MeasureModel(subject, landmarks);
    for (const bone::Measure & measure : report.list.measures)
    {
      std::cout << measure.name << ' ' << measure.text;
      for (const double value : measure.value)
      {
        std::cout << value << ' ';
      }
      std::cout << measure.unit << '\n';
    }
    for (const bone::MissingMeasure & missing : report.list.missing)
    {
      std::cout << missing.name << " was not measured: " << missing.reason << '\n';
    }

    // The primitives themselves, and an integral over a solid that they give.
    std::vector<bone::IdType> ids;
    const auto                femur = bone::FitFemur(bone::ExteriorSurface(subject, ids), landmarks);
    if (femur.head && subject.HasDensity())
    {
      const auto ball = bone::IntegrateSolid(subject, bone::MakeBall(femur.head->centre, 0.5 * femur.head->radius));
      std::cout << "mean density in the middle of the head " << ball.total.mean << ' '
                << bone::DensityQuantityName(subject.quantity) << '\n';
    }
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
