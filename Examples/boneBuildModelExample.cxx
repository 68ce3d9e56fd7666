/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/

// The whole job as one lazy pipeline: boneBuildModelExample CT LABELS PREFIX
//
// BuildPipeline chains the stages; a changed parameter re-runs its stage and those after it.

#include "boneBuildPlan.h"
#include "boneHierarchyIO.h"
#include "boneStageClock.h"

#include <cstdlib>
#include <iostream>

int
main(int argc, char ** argv)
{
  if (argc != 4)
  {
    std::cerr << "usage: boneBuildModelExample CT LABELS PREFIX\n";
    return EXIT_FAILURE;
  }
  try
  {
    bone::BuildPipeline pipeline(/* levels */ 2);
    bone::StageClock    clock(pipeline.GetStages());
    pipeline.SetImage(bone::ReadCT(argv[1]));
    pipeline.SetLabelImage(bone::ReadLabels(argv[2]));
    pipeline.GetSnake()->SetSliceStep(4.0);
    pipeline.SetContourSpacing(6.0);
    pipeline.GetFit()->SetDegree(2);

    // The view and the number of tetrahedra of the coarser level follow from the mesh.
    pipeline.GetQuality()->Update();
    const auto * mesh = pipeline.GetQuality()->GetOutput();
    pipeline.SetGeometry(bone::FrontView(mesh));
    pipeline.GetCollapse()->SetLevels({ mesh->GetNumberOfTetrahedra() / 5 });
    pipeline.Update();

    // Only the fit and what follows it run again.
    clock.Reset();
    pipeline.GetFit()->SetDegree(3);
    pipeline.Update();
    for (const auto & [name, stage] : pipeline.GetStages())
    {
      std::cout << name << ": " << clock.GetRuns(name) << (clock.GetRuns(name) == 1 ? " run\n" : " runs\n");
    }

    const auto * hierarchy = pipeline.GetCollapse()->GetOutput();
    bone::WriteHierarchy(hierarchy, argv[3]);
    for (std::size_t level = 0; level < pipeline.GetNumberOfLevels(); ++level)
    {
      bone::WriteImage(pipeline.GetRadiograph(level)->GetOutput(),
                       std::string(argv[3]) + "_drr_L" + std::to_string(level + 1) + ".mha");
    }
  }
  catch (const std::exception & error)
  {
    std::cerr << error.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
