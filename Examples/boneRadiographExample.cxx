/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// A radiograph of a density model from the front: boneRadiographExample MODEL.vtu DRR.mha

#include "boneDRRImageFilter.h"
#include "boneImageIO.h"
#include "boneMeshIO.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 3)
  {
    std::cerr << "usage: boneRadiographExample MODEL.vtu DRR.mha\n";
    return EXIT_FAILURE;
  }
  try
  {
    const auto    model = bone::ReadDensityMesh(argv[1]);
    const auto    points = model->GetArrays().points;
    bone::Vector3 lower = points.front();
    bone::Vector3 upper = points.front();
    for (const bone::Vector3 & point : points)
    {
      lower = lower.cwiseMin(point);
      upper = upper.cwiseMax(point);
    }

    // Patients lie along z (head up in the picture); the beam runs from front to back, along +y.
    auto geometry = bone::XRayGeometry::New();
    geometry->SetView(
      bone::XRayGeometry::Framing(lower, upper, bone::Vector3::UnitY(), bone::Vector3::UnitZ(), /* pixels */ 512));

    auto radiograph = bone::DRRImageFilter<bone::DensityMesh<double>, bone::CTImage>::New();
    radiograph->SetInput(model);
    radiograph->SetGeometry(geometry);
    radiograph->Update();
    bone::WriteImage(radiograph->GetOutput(), argv[2]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
