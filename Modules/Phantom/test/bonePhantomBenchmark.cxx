/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMakePhantom.h"
#include "bonePhantomImageSource.h"

#include <benchmark/benchmark.h>

#include <cmath>

namespace
{
using SourceType = bone::PhantomImageSource<itk::Image<float, 3>>;

void
MakeImage(benchmark::State & state, const std::string & name)
{
  const auto model = bone::MakePhantom(name);
  for (auto _ : state)
  {
    auto                    source = SourceType::New();
    SourceType::SpacingType spacing;
    spacing[0] = spacing[1] = 0.7;
    spacing[2] = 1.0;
    source->SetModel(model);
    source->SetSpacing(spacing);
    source->SetNoise(20.0);
    source->Update();
    state.SetItemsProcessed(source->GetOutput()->GetBufferedRegion().GetNumberOfPixels());
  }
}

void
EvaluateDensity(benchmark::State & state, const std::string & name)
{
  const auto model = bone::MakePhantom(name);
  double     t = 0.0;
  for (auto _ : state)
  {
    t += 0.01;
    benchmark::DoNotOptimize(model->Density({ 10.0 * std::cos(t), 10.0 * std::sin(t), 30.0 }));
  }
}
} // namespace

BENCHMARK_CAPTURE(MakeImage, Femur, "femur")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(MakeImage, Hemipelvis, "hemipelvis")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(EvaluateDensity, Femur, "femur");
BENCHMARK_CAPTURE(EvaluateDensity, Hemipelvis, "hemipelvis");
