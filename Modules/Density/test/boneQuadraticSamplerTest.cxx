/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneQuadraticSampler.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <vector>

namespace QuadraticSamplerTests
{
using namespace bone;

const std::array<int, 3> Size = { { 7, 5, 9 } };

std::vector<double>
Voxels(const std::function<double(const Vector3 &)> & f)
{
  std::vector<double> voxels;
  for (int v = 0; v < Size[0] * Size[1] * Size[2]; ++v)
  {
    voxels.push_back(f(Vector3(v % Size[0], v / Size[0] % Size[1], v / Size[0] / Size[1])));
  }
  return voxels;
}

/** A place at least `margin` voxels from the outermost voxel centres. */
Vector3
RandomPlace(std::mt19937 & random, double margin)
{
  Vector3 place;
  for (int axis = 0; axis < 3; ++axis)
  {
    place[axis] = std::uniform_real_distribution<double>(margin, Size[axis] - 1 - margin)(random);
  }
  return place;
}

double
Linear(const Vector3 & x)
{
  return 3 + 7 * x[0] - 4 * x[1] + 2.5 * x[2];
}

TEST(QuadraticSampler, PassesThroughTheVoxelsAndTakesTheNearestValueBeyond)
{
  std::mt19937                           random(3);
  std::uniform_real_distribution<double> uniform(-1000, 1000);
  const auto                             voxels = Voxels([&](const Vector3 &) { return uniform(random); });
  const QuadraticSampler<double>         sampler(voxels.data(), Size);
  for (std::size_t v = 0; v < voxels.size(); ++v)
  {
    const auto n = static_cast<int>(v);
    EXPECT_NEAR(sampler(Vector3(n % 7, n / 7 % 5, n / 35)), voxels[v], 1e-9);
  }
  EXPECT_EQ(sampler({ -3, 2.3, 20 }), sampler({ 0, 2.3, 8 }));
}

TEST(QuadraticSampler, QuadraticFieldsAreExactWhereNeighboursAreAndLinearOnesEverywhere)
{
  const auto quadratic = [](const Vector3 & x) {
    return 5 * x[0] * x[0] - 2 * x[1] * x[1] + x[2] * x[2] - 3 * x[0] * x[1] + 4 * x[1] * x[2] - x[0] * x[2] +
           Linear(x);
  };
  const auto                     bent = Voxels(quadratic), straight = Voxels(Linear);
  const QuadraticSampler<double> ofBent(bent.data(), Size), ofStraight(straight.data(), Size);
  std::mt19937                   random(3);
  for (int trial = 0; trial < 2000; ++trial)
  {
    const Vector3 inside = RandomPlace(random, 1), anywhere = RandomPlace(random, 0);
    EXPECT_NEAR(ofBent(inside), quadratic(inside), 1e-9);
    EXPECT_NEAR(ofStraight(anywhere), Linear(anywhere), 1e-9);
  }
}

TEST(QuadraticSampler, IsCubicConvolutionAlongAnAxis)
{
  const std::vector<float>      voxels = { 1, 2, 9, 12, 30, 7 };
  const QuadraticSampler<float> sampler(voxels.data(), { { 1, 1, 6 } });
  for (double t = 0; t < 1; t += 0.125)
  {
    const double keys = 2 + 0.5 * t * (9 - 1 + t * (2 * 1 - 5 * 2 + 4 * 9 - 12 + t * (3 * (2 - 9) + 12 - 1)));
    EXPECT_NEAR(sampler(Vector3(0, 0, 1 + t)), keys, 1e-12);
  }
}

TEST(QuadraticSampler, IsLinearInAnImageOneOrTwoVoxelsThick)
{
  const std::vector<short> voxels = { 10, 20 };
  EXPECT_EQ(QuadraticSampler<short>(voxels.data(), { { 2, 1, 1 } })({ 0.5, 0.3, -0.2 }), 15);
  EXPECT_EQ(QuadraticSampler<short>(voxels.data(), { { 1, 1, 2 } })({ 0, 0, 0.25 }), 12.5);
  EXPECT_EQ(QuadraticSampler<short>(voxels.data(), { { 1, 1, 1 } })({ 0.2, 0, 0.25 }), 10);
}

TEST(QuadraticSampler, StaysBetweenTheVoxelsAround)
{
  const auto                     voxels = Voxels([](const Vector3 & x) { return x[0] + x[2] > 7 ? 800.0 : 100.0; });
  const QuadraticSampler<double> sampler(voxels.data(), Size);
  std::mt19937                   random(5);
  for (int trial = 0; trial < 2000; ++trial)
  {
    const Vector3 place = RandomPlace(random, 0);
    EXPECT_GE(sampler(place), 100);
    EXPECT_LE(sampler(place), 800);
  }
}
} // namespace QuadraticSamplerTests
