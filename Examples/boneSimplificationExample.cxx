/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// A hierarchy of two coarser levels: boneSimplificationExample MODEL.vtu PREFIX

#include "boneHierarchyIO.h"
#include "boneMeshIO.h"
#include "boneTetraCollapseFilter.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 3)
  {
    std::cerr << "usage: boneSimplificationExample MODEL.vtu PREFIX\n";
    return EXIT_FAILURE;
  }
  try
  {
    const auto         model = bone::ReadDensityMesh(argv[1]);
    const bone::IdType count = model->GetNumberOfTetrahedra();
    auto               collapse = bone::TetraCollapseFilter<bone::DensityMesh<double>>::New();
    collapse->SetInput(model);
    collapse->SetLevels({ count / 5, count / 13 });
    collapse->Update();

    for (const auto & level : collapse->GetOutput()->GetLevels())
    {
      std::cout << level.mesh->GetNumberOfTetrahedra() << " tetrahedra, density within " << level.densityError
                << " (root mean square) of the first level's\n";
    }
    bone::WriteHierarchy(collapse->GetOutput(), argv[2]);
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
