/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourResampleFilter.h"
#include "boneMedialAxisFilter.h"
#include "boneSnakeContourFilter.h"

#include "boneContourTestTools.h"

#include <benchmark/benchmark.h>

namespace bone
{
namespace
{
using Filter = SnakeContourFilter<TestCT>;

// A tube of elliptic section, 48 slices of 200 x 200 pixels of 0.6 mm.
TestGrid
Grid()
{
  TestGrid grid;
  grid.size = { { 200, 200, 48 } };
  grid.spacing = { 0.6, 0.6, 1.0 };
  grid.origin = { -60, -60, 0 };
  return grid;
}

double
Tube(double x, double y, double z)
{
  return TubeDensity(x - 0.1 * z, 1.5 * y, 30.0, 26.0, 200.0);
}

const Filter *
Labelled()
{
  static const Filter::Pointer filter = [] {
    auto made = Filter::New();
    made->SetInput(MakeImage<TestCT>(Grid(), Tube));
    made->SetLabelImage(MakeImage<TestLabels>(
      Grid(), [](double x, double y, double z) { return std::hypot(x - 0.1 * z, 1.5 * y) < 30.0 ? 1 : 0; }));
    made->Update();
    return made;
  }();
  return filter;
}

void
FromLabel(benchmark::State & state)
{
  for ([[maybe_unused]] auto step : state)
  {
    auto filter = Filter::New();
    filter->SetInput(Labelled()->GetInput());
    filter->SetLabelImage(Labelled()->GetLabelImage());
    filter->SetRefineLabelOutline(state.range(0) != 0);
    filter->Update();
    benchmark::DoNotOptimize(filter->GetOutput());
  }
  state.SetItemsProcessed(state.iterations() * 48);
}
BENCHMARK(FromLabel)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();

void
FromOneContour(benchmark::State & state)
{
  auto start = ContourStack::New();
  start->SetFrame(Labelled()->GetOutput()->GetU(), Labelled()->GetOutput()->GetV());
  ContourSlice slice = Labelled()->GetOutput()->GetSlices()[20];
  slice.contours.resize(1);
  start->SetSlices({ slice });
  for ([[maybe_unused]] auto step : state)
  {
    auto filter = Filter::New();
    filter->SetInput(Labelled()->GetInput());
    filter->SetInitialContours(start);
    filter->Update();
    benchmark::DoNotOptimize(filter->GetOutput());
  }
  state.SetItemsProcessed(state.iterations() * 48);
}
BENCHMARK(FromOneContour)->Unit(benchmark::kMillisecond)->UseRealTime();

void
Resample(benchmark::State & state)
{
  for ([[maybe_unused]] auto step : state)
  {
    auto filter = ContourResampleFilter<>::New();
    filter->SetInput(Labelled()->GetOutput());
    filter->Update();
    benchmark::DoNotOptimize(filter->GetOutput());
  }
  state.SetItemsProcessed(state.iterations() * 48);
}
BENCHMARK(Resample)->Unit(benchmark::kMillisecond)->UseRealTime();

void
MedialAxis(benchmark::State & state)
{
  auto resample = ContourResampleFilter<>::New();
  resample->SetInput(Labelled()->GetOutput());
  resample->Update();
  for ([[maybe_unused]] auto step : state)
  {
    auto filter = MedialAxisFilter<>::New();
    filter->SetInput(resample->GetOutput());
    filter->Update();
    benchmark::DoNotOptimize(filter->GetOutput());
  }
  state.SetItemsProcessed(state.iterations() * 48);
}
BENCHMARK(MedialAxis)->Unit(benchmark::kMillisecond)->UseRealTime();
} // namespace
} // namespace bone
