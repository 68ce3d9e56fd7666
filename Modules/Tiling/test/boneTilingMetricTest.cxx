/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTilingMetric.h"

#include <gtest/gtest.h>

#include <cmath>

namespace TilingMetricTests
{
using bone::TilingMetricKind;
using bone::TilingStep;
using bone::Vector3;

TilingStep
OneEdge(const Vector3 & a, const Vector3 & b)
{
  TilingStep step;
  step.numberOfEdges = 1;
  step.edges[0] = a;
  step.edges[1] = b;
  return step;
}

/** A CT of two densities that meet at x = 4 mm. */
double
TwoDensities(const Vector3 & x)
{
  return x.x() < 4 ? 0.0 : 1000.0;
}

// Of five samples on 10 mm along x, at 1, 3, 5, 7 and 9 mm, two are 0 and three 1000: mean 600, variance 240000.
const TilingStep Across = OneEdge({ 0, 0, 0 }, { 10, 0, 0 });
const double     DeviationAcross = 10 * std::sqrt(240000.0);

TEST(TilingMetric, SpanIsTheLengthOfTheEdges)
{
  TilingStep step = OneEdge({ 0, 0, 0 }, { 3, 4, 0 });
  step.numberOfEdges = 2;
  step.edges[2] = { 1, 1, 1 };
  step.edges[3] = { 1, 1, 3 };
  EXPECT_DOUBLE_EQ(bone::SpanLengthMetric().Evaluate(step), 7.0);
}

TEST(TilingMetric, AreaIsThatOfTheFaces)
{
  TilingStep step;
  step.numberOfFaces = 2;
  step.faces = { Vector3(0, 0, 0), Vector3(3, 0, 0), Vector3(0, 4, 0),
                 Vector3(0, 0, 1), Vector3(0, 2, 1), Vector3(0, 0, 3) };
  EXPECT_DOUBLE_EQ(bone::AreaMetric().Evaluate(step), 8.0);
}

TEST(TilingMetric, MoreVolumeCostsLess)
{
  TilingStep step;
  step.volume = 5.0;
  EXPECT_DOUBLE_EQ(bone::VolumeMetric().Evaluate(step), -5.0);
}

TEST(TilingMetric, DensityDeviatesOnlyAlongEdgesFromOneSideToTheOther)
{
  const bone::DensityDeviationMetric metric(TwoDensities);
  EXPECT_NEAR(metric.Evaluate(Across), DeviationAcross, 1e-9);
  EXPECT_DOUBLE_EQ(metric.Evaluate(OneEdge({ 5, 0, 0 }, { 5, 20, 0 })), 0.0);
  EXPECT_DOUBLE_EQ(metric.Evaluate(OneEdge({ 3, 0, 0 }, { 3, 20, 0 })), 0.0);
}

TEST(TilingMetric, DensityBeyondTheImageIsNotCounted)
{
  const bone::DensityDeviationMetric metric(
    [](const Vector3 & x) { return x.x() < 6 ? TwoDensities(x) : std::nan(""); });
  // 0, 0 and 1000 are left: variance 1000^2 (1/3 - 1/9).
  EXPECT_NEAR(metric.Evaluate(Across), 10 * 1000 * std::sqrt(2.0 / 9.0), 1e-9);
}

TEST(TilingMetric, CombinedIsSpanAndAFiveHundredthOfTheDeviation)
{
  const bone::CombinedMetric metric(TwoDensities);
  EXPECT_NEAR(metric.Evaluate(Across), 10 + DeviationAcross / 500, 1e-9);
  EXPECT_NEAR(bone::CombinedMetric(TwoDensities, 0.25).Evaluate(Across), 10 + 0.25 * DeviationAcross, 1e-9);
}

TEST(TilingMetric, CombinedTakesALongerEdgeThatStaysWithinOneDensity)
{
  const TilingStep along = OneEdge({ 5, 0, 0 }, { 5, 15, 0 });
  EXPECT_GT(bone::SpanLengthMetric().Evaluate(along), bone::SpanLengthMetric().Evaluate(Across));
  EXPECT_LT(bone::CombinedMetric(TwoDensities).Evaluate(along), bone::CombinedMetric(TwoDensities).Evaluate(Across));
}

TEST(TilingMetric, CombinedIsSpanWithoutADensity)
{
  EXPECT_DOUBLE_EQ(bone::CombinedMetric(nullptr).Evaluate(Across), 10.0);
}

TEST(TilingMetric, EachKindMakesItsMetric)
{
  TilingStep step = Across;
  step.numberOfFaces = 1;
  step.faces = { Vector3(0, 0, 0), Vector3(3, 0, 0), Vector3(0, 4, 0) };
  step.volume = 5.0;
  const auto evaluate = [&](TilingMetricKind kind) {
    return bone::MakeTilingMetric(kind, TwoDensities)->Evaluate(step);
  };
  EXPECT_DOUBLE_EQ(evaluate(TilingMetricKind::Span), 10.0);
  EXPECT_DOUBLE_EQ(evaluate(TilingMetricKind::Area), 6.0);
  EXPECT_DOUBLE_EQ(evaluate(TilingMetricKind::Volume), -5.0);
  EXPECT_NEAR(evaluate(TilingMetricKind::Density), DeviationAcross, 1e-9);
  EXPECT_NEAR(evaluate(TilingMetricKind::Combined), 10 + DeviationAcross / 500, 1e-9);
  EXPECT_THROW(bone::MakeTilingMetric(TilingMetricKind::Density, nullptr), std::invalid_argument);
}
} // namespace TilingMetricTests
