/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneScatter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace ScatterTests
{
using namespace bone;

/** Photons behind an ellipse of line integral up to `depth` before air, with fine structure. */
std::vector<double>
BodyPhotons(const DetectorGrid & grid, double depth, double open)
{
  std::vector<double> photons;
  for (int r = 0; r < grid.size[1]; ++r)
  {
    for (int c = 0; c < grid.size[0]; ++c)
    {
      const double x = (c - 0.5 * grid.size[0]) / (0.35 * grid.size[0]),
                   y = (r - 0.4 * grid.size[1]) / (0.45 * grid.size[1]);
      const double chord = std::sqrt(std::max(0.0, 1 - x * x - y * y));
      photons.push_back(open * std::exp(-depth * chord * (1 + 0.1 * std::sin(0.5 * c) * std::cos(0.4 * r))));
    }
  }
  return photons;
}

const DetectorGrid grid{ { { 160, 120 } }, { 2.0, 2.5 } };

TEST(Scatter, TheBlurKeepsAConstantAndTheSumOfASpot)
{
  const std::vector<double> constant(grid.Count(), 3.5);
  for (const double v : BlurWidely(constant, grid, 40, Execution()))
  {
    ASSERT_NEAR(v, 3.5, 1e-12);
  }
  std::vector<double> spot(grid.Count(), 0.0);
  spot[60 * 160 + 80] = 1000;
  const auto blurred = BlurWidely(spot, grid, 25, Execution());
  EXPECT_NEAR(std::accumulate(blurred.begin(), blurred.end(), 0.0), 1000, 5);
}

TEST(Scatter, TheBlurIsAGaussianOfItsWidthInMillimetres)
{
  // 25 mm are 12.5 columns, in blocks of two, and 10 rows.
  std::vector<double> spot(grid.Count(), 0.0);
  spot[60 * 160 + 80] = spot[60 * 160 + 81] = 0.5;
  const auto   blurred = BlurWidely(spot, grid, 25, Execution());
  const double peak = 2.0 * 2.5 / (2 * 3.14159265358979 * 25 * 25);
  for (const auto & [c, r] :
       std::vector<std::pair<int, int>>{ { 80, 60 }, { 95, 60 }, { 80, 74 }, { 70, 50 }, { 60, 66 } })
  {
    const double x = 2.0 * (c - 80.5), y = 2.5 * (r - 60);
    EXPECT_NEAR(blurred[r * 160 + c], peak * std::exp(-(x * x + y * y) / (2 * 25 * 25)), 0.01 * peak) << c << ' ' << r;
  }
}

TEST(Scatter, OpenBeamScattersNothingAndAThickBodyByItsRatio)
{
  const ScatterModel        model{ 0.6, 30, 1000 };
  const std::vector<double> open(grid.Count(), 1000.0), thick(grid.Count(), 1.0);
  EXPECT_EQ(ComputeScatter(open, grid, model, Execution())[500], 0);
  EXPECT_NEAR(ComputeScatter(thick, grid, model, Execution())[500], 0.6 * 0.998001, 1e-9);
}

TEST(Scatter, ThePrimaryIsRecoveredFromItsSumWithScatter)
{
  for (const double ratio : { 0.1, 0.6, 1.5, 2.5 })
  {
    const ScatterModel model{ ratio, 40, 5000 };
    const auto         primary = BodyPhotons(grid, 4, 5000);
    auto               total = ComputeScatter(primary, grid, model, Execution());
    std::transform(total.begin(), total.end(), primary.begin(), total.begin(), std::plus<>());
    const auto solution = SubtractScatter(total, grid, model, 0.001, Execution());
    double     worst = 0, without = 0;
    for (std::size_t i = 0; i < primary.size(); ++i)
    {
      worst = std::max(worst, std::abs(std::log(solution.primary[i] / primary[i])));
      without = std::max(without, std::abs(std::log(total[i] / primary[i])));
    }
    EXPECT_LT(worst, 1e-3) << "of a line integral, ratio " << ratio;
    EXPECT_GT(without, 0.3 * ratio) << "there was scatter to subtract";
    EXPECT_LT(solution.iterations, 60);
  }
}

TEST(Scatter, NoiseDoesNotHoldTheIterationUp)
{
  std::mt19937                     random(4);
  std::normal_distribution<double> normal(0, 1);
  auto                             total = BodyPhotons(grid, 5, 300);
  for (double & photons : total)
  {
    photons = std::max(1e-2, photons + std::sqrt(photons) * normal(random));
  }
  EXPECT_LT(SubtractScatter(total, grid, { 0.6, 40, 300 }, 0.02, Execution()).iterations, 20);
}

TEST(Scatter, ThePrimaryStaysAboveItsLeastShare)
{
  // A pixel that is darker than the scatter around it allows.
  auto total = std::vector<double>(grid.Count(), 100.0);
  total[60 * 160 + 80] = 1e-3;
  const auto solution = SubtractScatter(total, grid, { 1.0, 30, 1000 }, 0.05, Execution());
  EXPECT_DOUBLE_EQ(solution.primary[60 * 160 + 80], 5e-5);
  EXPECT_NEAR(solution.primary[0], 100 / 1.9, 5);
}

TEST(Scatter, WithoutARatioNothingIsSubtracted)
{
  const auto total = BodyPhotons(grid, 2, 1);
  EXPECT_EQ(SubtractScatter(total, grid, { 0, 50, 1 }, 0.02, Execution()).primary, total);
}
} // namespace ScatterTests
