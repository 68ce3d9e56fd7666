/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourTiler.h"

#include <benchmark/benchmark.h>

#include <cmath>

namespace
{
/** A bowed tube of three nested ellipses a slice, `points` on the outer one. */
bone::ContourStack::Pointer
MakeTube(int slices, int points)
{
  constexpr double                   pi = 3.14159265358979323846;
  bone::ContourStack::SliceContainer container;
  for (int k = 0; k < slices; ++k)
  {
    bone::ContourSlice slice;
    slice.origin = bone::Vector3(0, 0, 2.0 * k);
    for (int layer = 0; layer < 3; ++layer)
    {
      bone::Contour contour;
      contour.layer = layer;
      contour.region = layer + 1;
      contour.id = layer;
      const double rx = (12 - 3 * layer) + std::sin(0.05 * k), ry = (10 - 3 * layer) + std::cos(0.07 * k);
      for (int i = 0; i < points; ++i)
      {
        const double t = 2 * pi * i / points;
        contour.points.emplace_back(3 * std::sin(0.02 * k) + rx * std::cos(t), ry * std::sin(t), 2.0 * k);
      }
      slice.contours.push_back(contour);
    }
    container.push_back(slice);
  }
  auto stack = bone::ContourStack::New();
  stack->SetSlices(container);
  return stack;
}

void
Tiling(benchmark::State & state)
{
  const auto  stack = MakeTube(static_cast<int>(state.range(0)), 24);
  std::size_t tetrahedra = 0;
  for (auto _ : state)
  {
    bone::TilingReport report;
    tetrahedra = bone::TileContours(*stack, {}, report).tetrahedra.size();
  }
  state.counters["tetrahedra"] = static_cast<double>(tetrahedra);
  state.SetComplexityN(static_cast<benchmark::IterationCount>(tetrahedra));
}
} // namespace

BENCHMARK(Tiling)->Arg(12)->Arg(80)->Arg(400)->Unit(benchmark::kMillisecond)->Complexity();
