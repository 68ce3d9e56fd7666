/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// The pose of a bone in two X-rays: boneRigidRegistrationExample MODEL.hierarchy.json VIEWS.json XRAY1 XRAY2 POSE.tfm
// The X-rays hold line integrals, as `bonetk drr CT --bilinear` writes them.

#include "boneRigidRadiographRegistration.h"

#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneImageIO.h"
#include "boneTransformIO.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 6)
  {
    std::cerr << "usage: boneRigidRegistrationExample MODEL.hierarchy.json VIEWS.json XRAY1 XRAY2 POSE.tfm\n";
    return EXIT_FAILURE;
  }
  try
  {
    const auto views = bone::ReadGeometry(argv[2]);
    auto       registration = bone::RigidRadiographRegistration<>::New();
    registration->SetModel(bone::ReadHierarchy(argv[1]));
    registration->SetView(0, bone::ReadRadiograph(argv[3]), views.at(0));
    registration->SetView(1, bone::ReadRadiograph(argv[4]), views.at(1));
    registration->SetSearchTranslation(20.0); // mm, degrees: how far the model may be off
    registration->SetSearchRotation(20.0);
    registration->Update();

    const auto & result = registration->GetResult();
    std::cout << "quality " << bone::ParameterText(result.quality) << ", standard deviations "
              << result.covariance.diagonal().head<3>().cwiseSqrt().transpose() << " mm\n";
    bone::WriteRigidTransform(*registration->GetTransform(), argv[5]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
