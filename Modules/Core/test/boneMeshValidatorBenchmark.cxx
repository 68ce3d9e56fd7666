/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshValidator.h"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace bone
{
namespace
{
// n x n x n cubes of six tetrahedra each around their diagonals; the inner half is region 2.
MeshArrays
Cubes(int n)
{
  constexpr int kuhn[6][4] = { { 0, 1, 3, 7 }, { 0, 3, 2, 7 }, { 0, 2, 6, 7 },
                               { 0, 6, 4, 7 }, { 0, 4, 5, 7 }, { 0, 5, 1, 7 } };
  MeshArrays    mesh;
  for (int p = 0; p < (n + 1) * (n + 1) * (n + 1); ++p)
  {
    mesh.points.emplace_back(p % (n + 1), p / (n + 1) % (n + 1), p / ((n + 1) * (n + 1)));
  }
  for (int c = 0; c < n * n * n; ++c)
  {
    const int  i = c % n, j = c / n % n, k = c / (n * n);
    const auto inside = [n](int x) { return x >= n / 4 && x < n - n / 4; };
    for (const auto & corners : kuhn)
    {
      Id4 tetra;
      for (int v = 0; v < 4; ++v)
      {
        const int corner = corners[v];
        tetra[v] = ((k + (corner >> 2)) * (n + 1) + j + (corner >> 1 & 1)) * (n + 1) + i + (corner & 1);
      }
      mesh.tetrahedra.push_back(tetra);
      mesh.region.push_back(inside(i) && inside(j) && inside(k) ? 2 : 1);
    }
  }
  mesh.neighbors = ComputeFaceNeighbors(mesh.tetrahedra);
  return mesh;
}

void
ValidateCubes(benchmark::State & state)
{
  const auto mesh = Cubes(static_cast<int>(state.range(0)));
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(ValidateMesh(mesh).IsValid());
  }
  state.counters["tetrahedra"] = static_cast<double>(mesh.tetrahedra.size());
  state.counters["valid"] = ValidateMesh(mesh).IsValid();
}
BENCHMARK(ValidateCubes)->Arg(8)->Arg(18)->Arg(40)->Unit(benchmark::kMillisecond);

void
FaceNeighborsOfCubes(benchmark::State & state)
{
  const auto mesh = Cubes(static_cast<int>(state.range(0)));
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(ComputeFaceNeighbors(mesh.tetrahedra));
  }
  state.counters["tetrahedra"] = static_cast<double>(mesh.tetrahedra.size());
}
BENCHMARK(FaceNeighborsOfCubes)->Arg(18)->Unit(benchmark::kMillisecond);
} // namespace
} // namespace bone
