/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "../../Core/test/boneTestBodies.h"
#include "boneTetraCollapseFilter.h"

#include <benchmark/benchmark.h>

namespace
{
using MeshType = bone::DensityMesh<double>;

void
Simplify(benchmark::State & state)
{
  bone::test::TubeShape shape;
  shape.slices = static_cast<int>(state.range(0));
  shape.around = 24;
  shape.bumps = 0.3;
  auto arrays = bone::test::MakeTube(shape);
  bone::test::SetDensity(
    arrays, 3, [](const bone::Vector3 & x) { return 500 + 300 * std::sin(x.x() / 9) * std::sin(x.z() / 11); });
  auto mesh = MeshType::New();
  mesh->SetArrays(arrays);
  const auto n = mesh->GetNumberOfTetrahedra();
  for (auto _ : state)
  {
    auto filter = bone::TetraCollapseFilter<MeshType>::New();
    filter->SetInput(mesh);
    filter->SetLevels({ n / 5, n / 13 });
    filter->Update();
    benchmark::DoNotOptimize(filter->GetOutput());
  }
  state.SetComplexityN(n);
  state.counters["tetrahedra"] = n;
}
BENCHMARK(Simplify)->Arg(13)->Arg(52)->Arg(208)->Arg(833)->Unit(benchmark::kMillisecond)->Complexity();
} // namespace
