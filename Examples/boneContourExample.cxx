/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// Contours of a bone on slices 3 mm apart, with layers and medial axes: boneContourExample CT LABELS CONTOURS.vtp

#include "boneContourIO.h"
#include "boneContourResampleFilter.h"
#include "boneImageIO.h"
#include "boneMedialAxisFilter.h"
#include "boneSnakeContourFilter.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 4)
  {
    std::cerr << "usage: boneContourExample CT LABELS CONTOURS.vtp\n";
    return EXIT_FAILURE;
  }
  try
  {
    auto snake = bone::SnakeContourFilter<bone::CTImage>::New();
    snake->SetInput(bone::ReadCT(argv[1]));
    snake->SetLabelImage(bone::ReadLabels(argv[2]));
    snake->SetSliceStep(3.0);

    auto resample = bone::ContourResampleFilter::New();
    resample->SetInput(snake->GetOutput());

    auto axis = bone::MedialAxisFilter::New();
    axis->SetInput(resample->GetOutput());
    axis->Update();

    for (const std::string & warning : snake->GetWarnings())
    {
      std::cerr << "warning: " << warning << '\n';
    }
    bone::WriteContours(axis->GetOutput(), argv[3]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
