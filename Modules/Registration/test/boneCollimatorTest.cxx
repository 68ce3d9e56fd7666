/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCollimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace CollimatorTests
{
using namespace bone;

constexpr std::array<int, 2> size{ { 400, 300 } };

/** Logarithm of the exposure behind a thigh with its bone, from the left to the right border, in a field that is a
 * rectangle, turned about the image's middle; half sizes in pixels. */
std::vector<double>
Exposure(double halfWidth, double halfHeight, double degrees, double noise = 0.0, bool letters = false)
{
  const double c = std::cos(degrees * 3.14159265358979 / 180), s = std::sin(degrees * 3.14159265358979 / 180);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1);
  std::vector<double>              exposure;
  for (int row = 0; row < size[1]; ++row)
  {
    for (int column = 0; column < size[0]; ++column)
    {
      const double x = column - 199.5, y = row - 149.5;
      const double across = std::abs(c * x + s * y) - halfWidth, down = std::abs(c * y - s * x) - halfHeight;
      // The penumbra is three pixels wide.
      const double open = std::clamp(0.5 - std::max(across, down) / 3, 0.0, 1.0);
      const double flesh = 2.2 * std::sqrt(std::max(0.0, 1 - y * y / (110.0 * 110.0)));
      const double bone = 1.5 * std::sqrt(std::max(0.0, 1 - (y - 0.2 * x) * (y - 0.2 * x) / (30.0 * 30.0)));
      double       photons = open * std::exp(-flesh - bone) + 0.01;
      photons = letters && row > 8 && row < 22 && column > 10 && column < 20 ? 0.8 : photons;
      exposure.push_back(std::log(std::max(1e-3, photons * (1 + noise * normal(random)))));
    }
  }
  return exposure;
}

/** How far the found edges, in any order, are from a turned rectangle's, pixels; infinite for another number. */
double
WorstOffset(const std::vector<CollimatorEdge> & edges, double halfWidth, double halfHeight, double degrees)
{
  if (edges.size() != 4)
  {
    return std::numeric_limits<double>::infinity();
  }
  double worst = 0;
  for (int side = 0; side < 4; ++side)
  {
    const double  angle = (degrees + 90 * side) * 3.14159265358979 / 180;
    const Vector2 normal(std::cos(angle), std::sin(angle));
    const auto    found = std::max_element(edges.begin(), edges.end(), [&](const auto & a, const auto & b) {
      return a.normal.dot(normal) < b.normal.dot(normal);
    });
    EXPECT_GT(found->normal.dot(normal), std::cos(0.03)) << "side " << side;
    const double offset = found->offset - found->normal.dot(Vector2(199.5, 149.5));
    worst = std::max(worst, std::abs(offset - (side % 2 == 0 ? halfWidth : halfHeight)));
  }
  return worst;
}

TEST(Collimator, FindsTheFourBordersOfAStraightField)
{
  EXPECT_LT(WorstOffset(FindCollimator(Exposure(150, 120, 0), size, 0.7), 150, 120, 0), 3);
}

TEST(Collimator, FindsTheBordersOfATurnedField)
{
  for (const double degrees : { 4.0, 15.0, -25.0 })
  {
    EXPECT_LT(WorstOffset(FindCollimator(Exposure(120, 95, degrees), size, 0.7), 120, 95, degrees), 3) << degrees;
  }
}

TEST(Collimator, NoiseAndLettersInTheShadowChangeNothing)
{
  EXPECT_LT(WorstOffset(FindCollimator(Exposure(130, 110, 8, 0.15, true), size, 0.7), 130, 110, 8), 4)
    << "pixels, the default margin";
}

TEST(Collimator, FindsBordersOnTwoSidesAlone)
{
  const auto edges = FindCollimator(Exposure(1000, 110, 0), size, 0.7);
  ASSERT_EQ(edges.size(), 2u);
  for (const auto & edge : edges)
  {
    EXPECT_GT(std::abs(edge.normal.y()), 0.99);
  }
}

TEST(Collimator, ABodyInAnOpenFieldHasNoBorders)
{
  EXPECT_TRUE(FindCollimator(Exposure(1000, 1000, 0), size, 0.7).empty());
  EXPECT_TRUE(FindCollimator(Exposure(1000, 1000, 0, 0.15), size, 0.7).empty());
  // A trunk that grows darker towards the lower border, and a knee before nothing.
  std::vector<double> trunk, disk;
  for (int row = 0; row < size[1]; ++row)
  {
    for (int column = 0; column < size[0]; ++column)
    {
      trunk.push_back(-4.0 / (1 + std::exp(-(row - 200) / 15.0)));
      const double far = std::hypot(column - 150.0, row - 100.0);
      disk.push_back(far < 90 ? 0.0 : -4.0);
    }
  }
  EXPECT_TRUE(FindCollimator(trunk, size, 0.7).empty());
  EXPECT_TRUE(FindCollimator(disk, size, 0.7).empty()) << "a round field has no straight borders";
}

TEST(Collimator, AnImageOfOneValueHasNoBorders)
{
  EXPECT_TRUE(FindCollimator(std::vector<double>(120000, -1.0), size, 0.7).empty());
}
} // namespace CollimatorTests
