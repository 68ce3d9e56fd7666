/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCorticalFit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace bone
{
namespace CorticalFitTests
{
constexpr double Blur = 0.45; // mm

BlurredCortex
Cortex(double thickness, double outer = 0.2)
{
  return { outer, thickness, 40.0, 1600.0, 250.0, Blur };
}

// Values of a cortex every 0.07 mm, in no order.
std::vector<CorticalSample>
SamplesOf(const BlurredCortex & cortex, double noise = 0.0, unsigned int seed = 1)
{
  std::mt19937                     random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<CorticalSample>      samples;
  for (double depth = -4.0; depth <= 10.0; depth += 0.07)
  {
    samples.push_back({ depth, cortex(depth) + noise * normal(random) });
  }
  std::shuffle(samples.begin(), samples.end(), random);
  return samples;
}

// Root mean square of what is left.
double
Residual(const std::vector<CorticalSample> & samples, const BlurredCortex & cortex)
{
  double sum = 0.0;
  for (const CorticalSample & sample : samples)
  {
    const double off = cortex(sample.depth) - sample.value;
    sum += off * off;
  }
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

CorticalFitRules
Known()
{
  CorticalFitRules rules;
  rules.blur = Blur;
  rules.cortical = 1600.0;
  return rules;
}

TEST(CorticalFit, TheModelHasItsLevelsAndHalfOfEachStepAtItsEdges)
{
  const BlurredCortex cortex = Cortex(6.0);
  EXPECT_NEAR(cortex(-5.0), 40.0, 1e-9);
  EXPECT_NEAR(cortex(3.2), 1600.0, 1e-6);
  EXPECT_NEAR(cortex(12.0), 250.0, 1e-9);
  EXPECT_NEAR(cortex(0.2), 820.0, 1e-6);
  EXPECT_NEAR(cortex(6.2), 925.0, 1e-6);
  EXPECT_NEAR(cortex(0.2 + Blur), 40.0 + 1560.0 * 0.8413447460685429, 1e-6);
}

TEST(CorticalFit, RecoversEveryThicknessWhereBlurAndDensityAreKnown)
{
  for (const double thickness : { 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.5, 6.0 })
  {
    for (const double outer : { -1.5, -0.4, 0.0, 0.7, 1.5 })
    {
      const CorticalFit fit = FitCortex(SamplesOf(Cortex(thickness, outer)), Known());
      ASSERT_EQ(fit.status, CorticalStatus::Found) << thickness << ' ' << outer;
      EXPECT_NEAR(fit.cortex.thickness, thickness, 1e-4) << outer;
      EXPECT_NEAR(fit.cortex.outer, outer, 1e-4) << thickness;
      EXPECT_NEAR(fit.cortex.outside, 40.0, 0.1);
      EXPECT_NEAR(fit.cortex.inside, 250.0, 0.1);
      EXPECT_LT(fit.residual, 0.01);
    }
  }
}

TEST(CorticalFit, RecoversBlurAndDensityOfAThickCortex)
{
  for (const double thickness : { 2.0, 3.0, 4.5, 6.0 })
  {
    const CorticalFit fit = FitCortex(SamplesOf(Cortex(thickness)), CorticalFitRules());
    ASSERT_EQ(fit.status, CorticalStatus::Found);
    EXPECT_NEAR(fit.cortex.thickness, thickness, 1e-3);
    EXPECT_NEAR(fit.cortex.cortical, 1600.0, 0.5);
    EXPECT_NEAR(fit.cortex.blur, Blur, 1e-3);
  }
}

TEST(CorticalFit, RecoversTheBlurOfAThinCortexOfKnownDensity)
{
  CorticalFitRules rules;
  rules.cortical = 1600.0;
  for (const double thickness : { 0.5, 0.8, 1.2 })
  {
    const CorticalFit fit = FitCortex(SamplesOf(Cortex(thickness)), rules);
    ASSERT_EQ(fit.status, CorticalStatus::Found);
    EXPECT_NEAR(fit.cortex.thickness, thickness, 1e-3);
    EXPECT_NEAR(fit.cortex.blur, Blur, 1e-3);
  }
}

TEST(CorticalFit, NoiseMovesTheThicknessLittleAndNotToOneSide)
{
  for (const double thickness : { 0.3, 1.0 })
  {
    double sum = 0.0, largest = 0.0;
    for (unsigned int seed = 1; seed <= 50; ++seed)
    {
      const CorticalFit fit = FitCortex(SamplesOf(Cortex(thickness), 20.0, seed), Known());
      ASSERT_EQ(fit.status, CorticalStatus::Found);
      sum += fit.cortex.thickness - thickness;
      largest = std::max(largest, std::abs(fit.cortex.thickness - thickness));
    }
    EXPECT_NEAR(sum / 50.0, 0.0, 0.01) << thickness;
    EXPECT_LT(largest, 0.06) << thickness;
  }
}

// With noise the residuals are not zero, and a wrong derivative ends elsewhere.
void
ExpectMinimum(CorticalFitRules rules, unsigned int seed)
{
  rules.outsideReach = rules.insideReach = 20.0; // all samples count,
  rules.minimumContrast = 400.0;                 // and none is taken for another bone
  const auto        samples = SamplesOf(Cortex(2.5), 60.0, seed);
  const CorticalFit fit = FitCortex(samples, rules);
  ASSERT_EQ(fit.status, CorticalStatus::Found);
  ASSERT_NEAR(Residual(samples, fit.cortex), fit.residual, 1e-9);
  using Member = double                  BlurredCortex::*;
  std::vector<std::pair<Member, double>> steps{ { &BlurredCortex::outer, 1e-4 },
                                                { &BlurredCortex::thickness, 1e-4 },
                                                { &BlurredCortex::outside, 0.02 },
                                                { &BlurredCortex::inside, 0.02 } };
  if (std::isnan(rules.cortical))
  {
    steps.emplace_back(&BlurredCortex::cortical, 0.02);
  }
  if (rules.blur == 0.0)
  {
    steps.emplace_back(&BlurredCortex::blur, 1e-4);
  }
  for (std::size_t k = 0; k < steps.size(); ++k)
  {
    for (const double sign : { -1.0, 1.0 })
    {
      BlurredCortex changed = fit.cortex;
      changed.*steps[k].first += sign * steps[k].second;
      EXPECT_GT(Residual(samples, changed), fit.residual) << "parameter " << k << ", seed " << seed;
    }
  }
}

TEST(CorticalFit, NoSmallChangeOfAParameterFitsNoisySamplesBetter)
{
  CorticalFitRules density;
  density.cortical = 1600.0;
  for (unsigned int seed = 1; seed <= 5; ++seed)
  {
    ExpectMinimum(CorticalFitRules(), seed);
    ExpectMinimum(density, seed);
    ExpectMinimum(Known(), seed);
  }
}

TEST(CorticalFit, WhereNothingStandsOutThereIsNoCortex)
{
  const CorticalFit flat = FitCortex(SamplesOf({ 0.0, 1.0, 40.0, 40.0, 40.0, Blur }), Known());
  EXPECT_EQ(flat.status, CorticalStatus::None);
  const CorticalFit step = FitCortex(SamplesOf({ 0.0, 1.0, 40.0, 300.0, 300.0, Blur }), Known());
  EXPECT_EQ(step.status, CorticalStatus::None);
  const CorticalFit faint = FitCortex(SamplesOf({ 0.0, 4.0, 40.0, 500.0, 420.0, Blur }), CorticalFitRules());
  EXPECT_EQ(faint.status, CorticalStatus::None);
}

TEST(CorticalFit, WhatIsDenseToItsEndIsSolid)
{
  const CorticalFit fit = FitCortex(SamplesOf({ 0.0, 30.0, 40.0, 1600.0, 250.0, Blur }), Known());
  EXPECT_EQ(fit.status, CorticalStatus::Solid);
}

TEST(CorticalFit, ACortexFarFromTheSurfaceIsAnother)
{
  EXPECT_EQ(FitCortex(SamplesOf(Cortex(1.0, 6.0)), Known()).status, CorticalStatus::None);
}

TEST(CorticalFit, TooFewSamplesAreOutside)
{
  EXPECT_EQ(FitCortex({}, Known()).status, CorticalStatus::Outside);
  auto inside = SamplesOf(Cortex(1.0));
  inside.erase(std::remove_if(inside.begin(), inside.end(), [](const CorticalSample & s) { return s.depth < 0.0; }),
               inside.end());
  EXPECT_EQ(FitCortex(inside, Known()).status, CorticalStatus::Outside);
  auto outside = SamplesOf(Cortex(1.0));
  outside.erase(std::remove_if(outside.begin(), outside.end(), [](const CorticalSample & s) { return s.depth > 0.5; }),
                outside.end());
  EXPECT_EQ(FitCortex(outside, Known()).status, CorticalStatus::Outside);
}

TEST(CorticalFit, AnotherBoneOutsideDoesNotCount)
{
  auto samples = SamplesOf(Cortex(1.0));
  for (CorticalSample & sample : samples)
  {
    sample.value += 1000.0 * 0.5 * std::erfc((sample.depth + 2.4) / 0.3);
  }
  const CorticalFit fit = FitCortex(samples, Known());
  ASSERT_EQ(fit.status, CorticalStatus::Found);
  EXPECT_NEAR(fit.cortex.thickness, 1.0, 0.03);
  EXPECT_NEAR(fit.cortex.outer, 0.2, 0.03);
}
} // namespace CorticalFitTests
} // namespace bone
