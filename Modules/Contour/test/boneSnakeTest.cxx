/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSnake.h"

#include "boneContourTestTools.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <random>

namespace bone
{
namespace SnakeTests
{
// A blurred disk (or ring) of radius r at c.
PlaneField
Disk(double r, const Vector2 & c, double noise = 0.0)
{
  PlaneField field;
  field.grid.size = { { 80, 70 } };
  field.grid.spacing = { 0.6, 0.7 };
  field.grid.origin = { -24.0, -24.0 };
  std::mt19937               random(11);
  std::normal_distribution<> normal(0.0, 1.0);
  for (int j = 0; j < field.grid.size[1]; ++j)
  {
    for (int i = 0; i < field.grid.size[0]; ++i)
    {
      const double inside = r - (field.grid.Node(i, j) - c).norm();
      field.values.push_back(static_cast<float>(50.0 + 1000.0 * Blurred(inside, 0.6) + noise * normal(random)));
    }
  }
  return field;
}

double
MeanRadius(const Polygon & contour, const Vector2 & c)
{
  double sum = 0.0;
  for (const Vector2 & q : contour)
  {
    sum += (q - c).norm();
  }
  return sum / static_cast<double>(contour.size());
}

TEST(CyclicPentadiagonal, SolvesAgainstADenseMatrix)
{
  std::mt19937                           random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int n : { 5, 6, 7, 8, 23 })
  {
    std::vector<double>  diagonal;
    std::vector<Vector2> right;
    Eigen::MatrixXd      dense = Eigen::MatrixXd::Zero(n, n);
    const double         first = -1.3;
    const double         second = 0.4;
    for (int i = 0; i < n; ++i)
    {
      diagonal.push_back(5.0 + uniform(random));
      right.emplace_back(uniform(random), uniform(random));
      dense(i, i) += diagonal.back();
      dense(i, (i + 1) % n) += first;
      dense((i + 1) % n, i) += first;
      dense(i, (i + 2) % n) += second;
      dense((i + 2) % n, i) += second;
    }
    std::vector<Vector2> x = right;
    CyclicPentadiagonal(diagonal, first, second).Solve(x);
    for (int i = 0; i < n; ++i)
    {
      Vector2 sum = Vector2::Zero();
      for (int j = 0; j < n; ++j)
      {
        sum += dense(i, j) * x[static_cast<std::size_t>(j)];
      }
      EXPECT_NEAR((sum - right[static_cast<std::size_t>(i)]).norm(), 0.0, 1e-12) << n << ", row " << i;
    }
  }
}

TEST(Snake, FindsABlurredDisksRadiusFromWithinAndWithout)
{
  const Vector2    centre(1.3, -0.7);
  const PlaneField image = Disk(11.0, centre);
  for (const double start : { 8.5, 10.0, 13.0, 14.5 })
  {
    const std::vector<Polygon> first = { Ellipse(start, start, 80, centre + Vector2(0.5, 0.5)) };
    const BoneEdges            edges(image, first, 0.4, 40.0);
    const SnakeResult          result = EvolveSnake(first[0], edges, {});
    ASSERT_FALSE(result.contour.empty());
    EXPECT_TRUE(result.converged);
    EXPECT_GT(result.support, 0.99);
    EXPECT_NEAR(MeanRadius(result.contour, centre), 11.0, 0.04) << "start " << start;
    for (const Vector2 & q : result.contour)
    {
      EXPECT_NEAR((q - centre).norm(), 11.0, 0.1);
    }
  }
}

TEST(Snake, NoiseMovesItLittle)
{
  const PlaneField           image = Disk(11.0, Vector2::Zero(), 40.0);
  const std::vector<Polygon> first = { Ellipse(12.5, 10.0, 80) };
  const SnakeResult          result = EvolveSnake(first[0], BoneEdges(image, first, 0.4, 150.0), {});
  EXPECT_NEAR(MeanRadius(result.contour, Vector2::Zero()), 11.0, 0.06);
}

TEST(Snake, RefinementStaysWithinItsBound)
{
  const PlaneField  image = Disk(11.0, Vector2::Zero());
  const Polygon     start = Ellipse(10.0, 10.0, 120);
  const BoneEdges   edges(image, { start }, 0.4, 40.0);
  const SnakeResult bounded = RefineSnake(start, edges, 0.5, {});
  for (const Vector2 & q : bounded.contour)
  {
    EXPECT_LE(DistanceTo(q, start), 0.5 + 1e-9);
  }
  const SnakeResult freer = RefineSnake(start, edges, 1.5, {});
  EXPECT_NEAR(MeanRadius(freer.contour, Vector2::Zero()), 11.0, 0.05);
}

TEST(Snake, WithoutAnEdgeThereIsNoSupport)
{
  PlaneField image = Disk(11.0, Vector2::Zero());
  std::fill(image.values.begin(), image.values.end(), 40.0F);
  const std::vector<Polygon> first = { Ellipse(8, 8, 80) };
  const SnakeResult          result = EvolveSnake(first[0], BoneEdges(image, first, 0.4, 40.0), {});
  EXPECT_EQ(result.support, 0.0);
}

TEST(Snake, UniformResamplingKeepsLengthAndSpacing)
{
  const Polygon contour = ResampleUniform(Ellipse(10, 4, 400), 0.5);
  double        low = 1e9;
  double        high = 0.0;
  for (std::size_t i = 0; i < contour.size(); ++i)
  {
    const double d = (contour[(i + 1) % contour.size()] - contour[i]).norm();
    low = std::min(low, d);
    high = std::max(high, d);
  }
  EXPECT_NEAR(high, 0.5, 0.01);
  EXPECT_GT(low, 0.47);
}
} // namespace SnakeTests
} // namespace bone
