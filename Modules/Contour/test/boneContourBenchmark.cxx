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
    auto filter = ContourResampleFilter::New();
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
  auto resample = ContourResampleFilter::New();
  resample->SetInput(Labelled()->GetOutput());
  resample->Update();
  for ([[maybe_unused]] auto step : state)
  {
    auto filter = MedialAxisFilter::New();
    filter->SetInput(resample->GetOutput());
    filter->Update();
    benchmark::DoNotOptimize(filter->GetOutput());
  }
  state.SetItemsProcessed(state.iterations() * 48);
}
BENCHMARK(MedialAxis)->Unit(benchmark::kMillisecond)->UseRealTime();

// A femur's shaft in a CT of 512 x 512 pixels of 0.7 mm, slices 1 mm apart.
struct WholeCT
{
  TestCT::Pointer       ct;
  TestLabels::Pointer   labels;
  ContourStack::Pointer start;

  explicit WholeCT(unsigned int slices)
  {
    TestGrid grid;
    grid.size = { { 512, 512, 1 } };
    grid.spacing = { 0.7, 0.7, 1.0 };
    grid.origin = { -179, -179, 0 };
    const auto shaft = [](double x, double y) { return std::hypot(x - 60.0, 1.2 * y); };
    const auto section = MakeImage<TestCT>(
      grid, [&](double x, double y, double) { return TubeDensity(shaft(x, y), 0.0, 18.0, 12.0, 20.0); });
    const auto inside =
      MakeImage<TestLabels>(grid, [&](double x, double y, double) { return shaft(x, y) < 18.0 ? 1 : 0; });
    ct = Repeat<TestCT>(section, slices);
    labels = Repeat<TestLabels>(inside, slices);
    start = ContourStack::New();
    Contour contour;
    for (const Vector2 & q : Ellipse(19.0, 16.0, 80, { 60.0, 0.0 }))
    {
      contour.points.push_back({ q.x(), q.y(), 0.0 });
    }
    ContourSlice slice;
    slice.contours = { contour };
    start->SetSlices({ slice });
  }

  // The section on every slice, two pixels along x every eight slices.
  template <typename TImage>
  static typename TImage::Pointer
  Repeat(const TImage * section, unsigned int slices)
  {
    auto                        image = TImage::New();
    typename TImage::RegionType region = section->GetBufferedRegion();
    const std::size_t           count = region.GetNumberOfPixels();
    region.SetSize(2, slices);
    image->CopyInformation(section);
    image->SetRegions(region);
    image->Allocate();
    for (unsigned int k = 0; k < slices; ++k)
    {
      const std::size_t shift = 2 * (k / 8);
      std::copy_n(section->GetBufferPointer(), count - shift, image->GetBufferPointer() + k * count + shift);
      std::fill_n(image->GetBufferPointer() + k * count, shift, section->GetBufferPointer()[0]);
    }
    return image;
  }
};

// range(0): slices; range(1): 0 label as given, 1 refined, 2 from one contour. To medial axes.
void
WholeJob(benchmark::State & state)
{
  const WholeCT whole(static_cast<unsigned int>(state.range(0)));
  for ([[maybe_unused]] auto step : state)
  {
    auto snake = Filter::New();
    snake->SetInput(whole.ct);
    if (state.range(1) == 2)
    {
      snake->SetInitialContours(whole.start);
    }
    else
    {
      snake->SetLabelImage(whole.labels);
      snake->SetRefineLabelOutline(state.range(1) == 1);
    }
    auto resample = ContourResampleFilter::New();
    resample->SetInput(snake->GetOutput());
    auto axes = MedialAxisFilter::New();
    axes->SetInput(resample->GetOutput());
    axes->Update();
    benchmark::DoNotOptimize(axes->GetOutput());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(WholeJob)->ArgsProduct({ { 125, 250 }, { 0, 1, 2 } })->Unit(benchmark::kMillisecond)->UseRealTime();
} // namespace
} // namespace bone
