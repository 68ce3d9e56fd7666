/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityEvaluation.h"
#include "boneDensityFitFilter.h"
#include "boneDensityImageFilter.h"
#include "boneDensityTestMeshes.h"

#include <benchmark/benchmark.h>

namespace
{
using namespace bone;

/** A block of 33,000 tetrahedra of about 10 mm^3 (paper, Table 1), in a CT of 0.7 x 0.7 x 1 mm: 20 voxels in each. */
MeshArrays
BoneSizedBlock(int layers = 28)
{
  return test::MakeBlock({ { 14, 14, layers } }, Vector3(4, 4, 6), 3.9, 0.2);
}

test::Image::Pointer
BoneSizedImage(int layers = 28)
{
  auto                  image = test::Image::New();
  test::Image::SizeType size = { { 92, 92, static_cast<itk::SizeValueType>(15 + 4 * layers) } };
  const double          spacing[3] = { 0.7, 0.7, 1.0 };
  image->SetRegions(size);
  image->SetSpacing(spacing);
  image->Allocate();
  for (itk::ImageRegionIteratorWithIndex<test::Image> it(image, image->GetBufferedRegion()); !it.IsAtEnd(); ++it)
  {
    const auto & i = it.GetIndex();
    it.Set(static_cast<float>(test::Smooth(Vector3(0.7 * i[0], 0.7 * i[1], i[2]))));
  }
  return image;
}

DensityFitFilter<>::Pointer
MakeFit(int degree, bool continuous, int layers = 28)
{
  auto filter = DensityFitFilter<>::New();
  filter->SetInput(test::ToMesh(BoneSizedBlock(layers)));
  filter->SetImage(BoneSizedImage(layers));
  filter->SetDegree(degree);
  filter->SetContinuous(continuous);
  return filter;
}

void
Fit(benchmark::State & state)
{
  auto filter = MakeFit(static_cast<int>(state.range(0)), state.range(1) != 0);
  for (auto _ : state)
  {
    filter->Modified();
    filter->Update();
  }
  state.counters["tetrahedra"] = static_cast<double>(filter->GetOutput()->GetNumberOfTetrahedra());
}
BENCHMARK(Fit)
  ->ArgNames({ "degree", "continuous" })
  ->ArgsProduct({ { 0, 1, 3, 6, 8 }, { 0 } })
  ->ArgsProduct({ { 1, 3 }, { 1 } })
  ->Unit(benchmark::kMillisecond)
  ->MeasureProcessCPUTime()
  ->UseRealTime();

/** The same density of cells and voxels, more of them: the cost should grow as they do. */
void
FitOfMore(benchmark::State & state)
{
  auto filter = MakeFit(3, state.range(1) != 0, static_cast<int>(state.range(0)));
  for (auto _ : state)
  {
    filter->Modified();
    filter->Update();
  }
  state.counters["tetrahedra"] = static_cast<double>(filter->GetOutput()->GetNumberOfTetrahedra());
}
BENCHMARK(FitOfMore)
  ->ArgNames({ "layers", "continuous" })
  ->ArgsProduct({ { 14, 28, 56, 112 }, { 0, 1 } })
  ->Unit(benchmark::kMillisecond)
  ->MeasureProcessCPUTime()
  ->UseRealTime();

void
Sample(benchmark::State & state)
{
  auto fit = MakeFit(static_cast<int>(state.range(0)), false);
  fit->Update();
  auto filter = DensityImageFilter<>::New();
  filter->SetInput(fit->GetOutput());
  filter->SetReferenceImage(fit->GetImage());
  for (auto _ : state)
  {
    filter->Modified();
    filter->Update();
  }
}
BENCHMARK(Sample)
  ->ArgName("degree")
  ->Arg(0)
  ->Arg(3)
  ->Arg(8)
  ->Unit(benchmark::kMillisecond)
  ->MeasureProcessCPUTime()
  ->UseRealTime();

void
Locate(benchmark::State & state)
{
  const MeshArrays                       mesh = BoneSizedBlock();
  const TetraLocator                     locator(mesh);
  std::mt19937                           random(1);
  std::uniform_real_distribution<double> uniform(5, 50);
  std::vector<Vector3>                   points(4096);
  for (Vector3 & x : points)
  {
    x = Vector3(uniform(random), uniform(random), 2 * uniform(random));
  }
  std::size_t at = 0;
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(locator.Find(points[at++ % points.size()]).cell);
  }
}
BENCHMARK(Locate);

void
BuildLocator(benchmark::State & state)
{
  const MeshArrays mesh = BoneSizedBlock();
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(TetraLocator(mesh).GetMesh().points.size());
  }
}
BENCHMARK(BuildLocator)->Unit(benchmark::kMillisecond);
} // namespace
