/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// The CT of an analytic femur: bonePhantomExample CT LABELS
//
// The density is known at every point, so that everything made from the CT can be measured against the truth.

#include "boneFemurPhantom.h"
#include "boneImageIO.h"
#include "bonePhantomImageSource.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 3)
  {
    std::cerr << "usage: bonePhantomExample CT LABELS\n";
    return EXIT_FAILURE;
  }
  try
  {
    using SourceType = bone::PhantomImageSource<bone::CTImage>;
    const auto femur = std::make_shared<const bone::FemurPhantom>();

    auto source = SourceType::New();
    source->SetModel(femur);
    SourceType::SpacingType spacing;
    spacing.Fill(1.5);
    source->SetSpacing(spacing);
    source->SetNoise(20.0);
    source->Update();
    bone::WriteImage(source->GetOutput(), argv[1]);
    bone::WriteImage(source->GetLabelOutput(), argv[2]);

    std::cout << "density in the middle of the head: " << femur->Density(femur->GetHeadCentre()) << " HU\n";
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
