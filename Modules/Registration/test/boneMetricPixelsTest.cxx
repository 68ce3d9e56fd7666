/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMetricPixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace MetricPixelsTests
{
using namespace bone;

RadiographView
View(int columns, int rows)
{
  RadiographView view;
  view.view.size = { { columns, rows } };
  view.values.assign(static_cast<std::size_t>(columns * rows), 1.0f);
  return view;
}

TEST(MetricPixels, AWeightIsTheLeastWithinTheRadius)
{
  RadiographView view = View(5, 4);
  EXPECT_EQ(CountedWeights(view, 0), std::vector<float>(20, 1.0f));
  view.weights.assign(20, 0.75f);
  view.weights[6] = 0.5f; // column 1, row 1
  view.weights[19] = 0.0f;
  const auto counted = CountedWeights(view, 1);
  for (int i = 0; i < 20; ++i)
  {
    const int   column = i % 5, row = i / 5;
    const bool  inside = column > 0 && column < 4 && row > 0 && row < 3;
    const float expected = !inside || (column == 3 && row == 2) ? 0.0f : column < 3 ? 0.5f : 0.75f;
    EXPECT_EQ(counted[static_cast<std::size_t>(i)], expected) << i;
  }
}

TEST(MetricPixels, WeightsThatAreNoneAreZero)
{
  RadiographView view = View(3, 1);
  view.weights = { -1.0f, std::numeric_limits<float>::quiet_NaN(), 0.5f };
  EXPECT_EQ(CountedWeights(view, 0), (std::vector<float>{ 0.0f, 0.0f, 0.5f }));
}

TEST(MetricPixels, RefusesOtherSizes)
{
  RadiographView view = View(4, 4);
  EXPECT_THROW(CountedWeights(view, 2), std::invalid_argument);
  view.weights.assign(15, 1.0f);
  EXPECT_THROW(CountedWeights(view, 0), std::invalid_argument);
  view.weights.clear();
  view.values.pop_back();
  EXPECT_THROW(CountedWeights(view, 0), std::invalid_argument);
}

TEST(MetricPixels, ABoxHoldsAllThatShows)
{
  std::vector<float> first(5 * 4, 0.0f), second(first);
  PixelBox           box = BoxOf({ first.data(), second.data() }, { { 5, 4 } });
  EXPECT_EQ(box.GetNumberOfPixels(), 0u);
  first[1 * 5 + 2] = -1.0f;
  box = BoxOf({ first.data(), second.data() }, { { 5, 4 } });
  EXPECT_EQ(box.first, (std::array<int, 2>{ 2, 1 }));
  EXPECT_EQ(box.end, (std::array<int, 2>{ 3, 2 }));
  second[3 * 5 + 0] = 1.0f;
  second[3 * 5 + 4] = std::numeric_limits<float>::quiet_NaN();
  box = BoxOf({ first.data(), second.data() }, { { 5, 4 } });
  EXPECT_EQ(box.first, (std::array<int, 2>{ 0, 1 }));
  EXPECT_EQ(box.end, (std::array<int, 2>{ 5, 4 }));
}

TEST(MetricPixels, GramSumsAreProducts)
{
  const Eigen::MatrixXf part = Eigen::MatrixXf::Random(6, 3);
  GramSum               sum(3);
  sum.Add(part, 6);
  sum.Add(part, 2);
  const Eigen::MatrixXf expected = part.transpose() * part + part.topRows(2).transpose() * part.topRows(2);
  EXPECT_LT((sum.Get() - expected.cast<double>()).norm(), 1e-5);
}
} // namespace MetricPixelsTests
