/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// Pose, shape and density of a bone in two X-rays:
//   boneDeformableRegistrationExample ATLAS.h5 VIEWS.json XRAY1 XRAY2 BONE.vtu
// The X-rays hold line integrals, as `bonetk drr CT --bilinear` writes them; `bonetk train` makes the atlas.

#include "boneDeformableRadiographRegistration.h"

#include "boneGeometryIO.h"
#include "boneImageIO.h"
#include "boneMeshIO.h"
#include "boneModelIO.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 6)
  {
    std::cerr << "usage: boneDeformableRegistrationExample ATLAS.h5 VIEWS.json XRAY1 XRAY2 BONE.vtu\n";
    return EXIT_FAILURE;
  }
  try
  {
    const auto views = bone::ReadGeometry(argv[2]);
    auto       registration = bone::DeformableRadiographRegistration<>::New();
    registration->SetModel(bone::ReadStatisticalModel(argv[1]));
    registration->SetView(0, bone::ReadRadiograph(argv[3]), views.at(0));
    registration->SetView(1, bone::ReadRadiograph(argv[4]), views.at(1));
    registration->SetSearchTranslation(10.0); // mm, degrees: how far the atlas may be off
    registration->SetSearchRotation(10.0);
    registration->SetPixels(128);
    registration->SetSearchPixels(64);
    registration->SetSmoothModes(15);
    registration->Update();

    const auto & result = registration->GetResult();
    std::cout << "cost " << result.cost << ", shape coefficients "
              << result.coefficients.head(result.shapeModes).transpose() << " standard deviations\n";
    bone::WriteDensityMesh(registration->GetOutput(), argv[5]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
