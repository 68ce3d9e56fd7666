/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// A project that uses an installed BoneTK: a small phantom through all stages.

#include "boneContourResampleFilter.h"
#include "boneContourTilingMeshSource.h"
#include "boneDRRImageFilter.h"
#include "boneDensityFitFilter.h"
#include "boneFemurPhantom.h"
#include "boneImageIO.h"
#include "boneMedialAxisFilter.h"
#include "boneMeshIO.h"
#include "bonePhantomImageSource.h"
#include "boneSnakeContourFilter.h"
#include "boneTetraCollapseFilter.h"
#include "boneTetraSmoothingFilter.h"

#include <iostream>

int
main()
{
  using Mesh = bone::DensityMesh<double>;
  try
  {
    using Source = bone::PhantomImageSource<bone::CTImage>;
    auto phantom = Source::New();
    phantom->SetModel(std::make_shared<const bone::FemurPhantom>());
    Source::SpacingType spacing;
    spacing.Fill(2.0);
    phantom->SetSpacing(spacing);
    phantom->Update();

    auto snake = bone::SnakeContourFilter<bone::CTImage>::New();
    snake->SetInput(phantom->GetOutput());
    snake->SetLabelImage(phantom->GetLabelOutput());
    snake->SetSliceStep(8.0);
    auto resample = bone::ContourResampleFilter::New();
    resample->SetInput(snake->GetOutput());
    resample->SetMaximumSpacing(8.0);
    auto axis = bone::MedialAxisFilter::New();
    axis->SetInput(resample->GetOutput());
    auto tiling = bone::ContourTilingMeshSource<Mesh>::New();
    tiling->SetInput(axis->GetOutput());
    auto smoothing = bone::TetraSmoothingFilter<Mesh>::New();
    smoothing->SetInput(tiling->GetOutput());
    auto fit = bone::DensityFitFilter<bone::CTImage, Mesh>::New();
    fit->SetImage(phantom->GetOutput());
    fit->SetMesh(smoothing->GetOutput());
    fit->SetDegree(1);
    fit->Update();
    bone::WriteDensityMesh(fit->GetOutput(), "downstream.vtu");
    std::cout << bone::ReadDensityMesh("downstream.vtu")->GetNumberOfTetrahedra() << " tetrahedra\n";
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
