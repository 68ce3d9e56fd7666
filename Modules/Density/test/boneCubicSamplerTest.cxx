/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCubicSampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace CubicSamplerTests
{
using namespace bone;

TEST(CubicSampler, PassesThroughTheVoxels)
{
  const std::array<int, 3>              size = { { 7, 5, 9 } };
  std::mt19937                          random(3);
  std::uniform_real_distribution<float> uniform(-1000, 1000);
  std::vector<float>                    values(7 * 5 * 9);
  for (float & x : values)
  {
    x = uniform(random);
  }
  const CubicSampler sampler(values, size);
  for (int v = 0; v < 7 * 5 * 9; ++v)
  {
    EXPECT_NEAR(sampler(Vector3(v % 7, v / 7 % 5, v / 35)), values[v], 2e-3);
  }
  EXPECT_EQ(sampler(Vector3(-3, 2, 20)), sampler(Vector3(0, 2, 8)));
}

TEST(CubicSampler, IsNearerToASmoothFunctionThanLinearInterpolation)
{
  const int          n = 24;
  const auto         f = [](double x) { return 100 * std::cos(0.7 * x); };
  std::vector<float> values(n);
  for (int i = 0; i < n; ++i)
  {
    values[i] = static_cast<float>(f(i));
  }
  const CubicSampler sampler(values, { { n, 1, 1 } });
  for (double x = 8.5; x < 15; x += 1)
  {
    const double linear = (f(x - 0.5) + f(x + 0.5)) / 2;
    EXPECT_LT(std::abs(sampler(Vector3(x, 0, 0)) - f(x)), 0.3 * std::abs(linear - f(x)) + 0.1);
  }
}

TEST(CubicSampler, ConstantsStayAndSmallBlocksWork)
{
  for (const std::array<int, 3> & size : { std::array<int, 3>{ { 1, 1, 1 } }, { { 2, 1, 3 } }, { { 40, 2, 2 } } })
  {
    const CubicSampler sampler(std::vector<float>(static_cast<std::size_t>(size[0]) * size[1] * size[2], 7.0F), size);
    EXPECT_NEAR(sampler(Vector3(0.3, 0.4, 0.5)), 7, 1e-5);
  }
  EXPECT_THROW(CubicSampler({ 1.0F }, { { 2, 1, 1 } }), std::invalid_argument);
}
} // namespace CubicSamplerTests
