/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// The bone of an atlas in a CT without a label map, and its label map:
//   boneAtlasVolumeExample ATLAS.h5 CT BONE.vtu LABELS
// `bonetk train` makes the atlas.

#include "boneAtlasVolumeRegistration.h"

#include "boneImageIO.h"
#include "boneMeshIO.h"
#include "boneModelIO.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 5)
  {
    std::cerr << "usage: boneAtlasVolumeExample ATLAS.h5 CT BONE.vtu LABELS\n";
    return EXIT_FAILURE;
  }
  try
  {
    auto registration = bone::AtlasVolumeRegistration<>::New();
    registration->SetImage(bone::ReadCT(argv[2]));
    registration->SetModel(bone::ReadStatisticalModel(argv[1]));
    registration->SetMirror(bone::MirrorMode::Try); // the side is not known
    registration->SetHypotheses(100000);
    registration->SetSmoothModes(60);
    registration->Update();

    const auto & result = registration->GetResult();
    std::cout << 100.0 * result.support.supported << " % of the surface on edges, volume "
              << result.regions.back().volume << " mm^3" << (result.mirrored ? ", of the other side\n" : "\n");
    bone::WriteDensityMesh(registration->GetOutput(), argv[3]);
    bone::WriteImage(registration->GetLabelImage(), argv[4]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
