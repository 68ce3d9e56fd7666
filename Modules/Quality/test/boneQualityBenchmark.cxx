/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "../../Core/test/boneTestBodies.h"
#include "boneMeshQualityFilter.h"
#include "boneTetraSmoothingFilter.h"
#include "boneTetraSwapFilter.h"

#include <benchmark/benchmark.h>

namespace
{
using MeshType = bone::DensityMesh<double>;

MeshType::Pointer
MakeRod(int slices)
{
  bone::test::TubeShape shape;
  shape.slices = slices;
  shape.around = 24;
  shape.bumps = 0.3;
  auto mesh = MeshType::New();
  mesh->SetArrays(bone::test::MakeTube(shape));
  return mesh;
}

template <typename TFilter>
void
Run(benchmark::State & state)
{
  const auto mesh = MakeRod(static_cast<int>(state.range(0)));
  for (auto _ : state)
  {
    auto filter = TFilter::New();
    filter->SetInput(mesh);
    filter->Update();
    benchmark::DoNotOptimize(filter->GetOutput());
  }
  state.SetComplexityN(mesh->GetNumberOfTetrahedra());
  state.counters["tetrahedra"] = mesh->GetNumberOfTetrahedra();
}

BENCHMARK_TEMPLATE(Run, bone::TetraSmoothingFilter<MeshType>)
  ->Arg(13)
  ->Arg(52)
  ->Arg(208)
  ->Unit(benchmark::kMillisecond)
  ->Complexity();
BENCHMARK_TEMPLATE(Run, bone::TetraSwapFilter<MeshType>)->Arg(13)->Arg(52)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(Run, bone::MeshQualityFilter<MeshType>)->Arg(13)->Arg(52)->Unit(benchmark::kMillisecond);
} // namespace
