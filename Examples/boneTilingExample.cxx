/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// A layered tetrahedral mesh from contours: boneTilingExample CONTOURS.vtp MESH.vtu

#include "boneContourIO.h"
#include "boneContourTilingMeshSource.h"
#include "boneMeshIO.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 3)
  {
    std::cerr << "usage: boneTilingExample CONTOURS.vtp MESH.vtu\n";
    return EXIT_FAILURE;
  }
  try
  {
    auto tiling = bone::ContourTilingMeshSource<bone::DensityMesh<double>>::New();
    tiling->SetInput(bone::ReadContours(argv[1]));
    tiling->SetMetric(bone::TilingMetricKind::Span);
    tiling->Update();

    const bone::TilingReport & report = tiling->GetReport();
    std::cout << report.slabs << " slabs, " << report.branchings << " of them with branches\n";
    bone::WriteDensityMesh(tiling->GetOutput(), argv[2]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
