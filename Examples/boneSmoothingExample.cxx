/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// Smoothing, and what it does to the tetrahedra: boneSmoothingExample MESH.vtu SMOOTHED.vtu

#include "boneMeshIO.h"
#include "boneQualityMeasures.h"
#include "boneTetraSmoothingFilter.h"

#include <cstdlib>
#include <iostream>

namespace
{
void
PrintQuality(const char * when, const bone::MeshArrays & mesh)
{
  const auto quality = bone::SummarizeQuality(mesh, bone::QualityMeasure::RadiusRatio);
  std::cout << when << ": radius ratio " << quality.mean << " on average, " << quality.percentile1
            << " at the 1st percentile\n";
}
} // namespace

int
main(int argc, char ** argv)
{
  if (argc != 3)
  {
    std::cerr << "usage: boneSmoothingExample MESH.vtu SMOOTHED.vtu\n";
    return EXIT_FAILURE;
  }
  try
  {
    const auto mesh = bone::ReadDensityMesh(argv[1]);
    auto       smoothing = bone::TetraSmoothingFilter<bone::DensityMesh<double>>::New();
    smoothing->SetInput(mesh);
    smoothing->SetMethod(bone::SmoothingMethod::Enhanced);
    smoothing->SetIterations(10);
    smoothing->Update();

    PrintQuality("before", mesh->GetArrays());
    PrintQuality("after", smoothing->GetOutput()->GetArrays());
    bone::WriteDensityMesh(smoothing->GetOutput(), argv[2]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
