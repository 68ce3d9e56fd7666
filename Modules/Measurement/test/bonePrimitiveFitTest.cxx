/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePrimitiveFit.h"

#include <gtest/gtest.h>

#include <random>

namespace PrimitiveFitTests
{
using namespace bone;

struct Cloud
{
  std::vector<Vector3> points;
  std::vector<double>  weights;
};

/** On the cap of a sphere of radius 20 about (5, -3, 8), moved out by noise; `outliers` more, 3 mm further in. */
Cloud
Cap(double noise, int outliers)
{
  std::mt19937                           random(4);
  std::normal_distribution<double>       normal;
  std::uniform_real_distribution<double> uniform(0.5, 2.0);
  Cloud                                  cloud;
  while (cloud.points.size() < std::size_t(400 + outliers))
  {
    Vector3 u(normal(random), normal(random), normal(random));
    u.normalize();
    if (u.z() > 0.2)
    {
      const bool outlier = cloud.points.size() >= 400;
      cloud.points.push_back(Vector3(5, -3, 8) + (20.0 + noise * normal(random) - (outlier ? 3.0 : 0.0)) * u);
      cloud.weights.push_back(uniform(random));
    }
  }
  return cloud;
}

TEST(PrimitiveFit, PointsOnASphereGiveIt)
{
  const auto cloud = Cap(0.0, 0);
  const auto sphere = FitSphere(cloud.points, cloud.weights);
  EXPECT_NEAR((sphere.centre - Vector3(5, -3, 8)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(sphere.radius, 20.0, 1e-9);
  EXPECT_NEAR(sphere.deviation, 0.0, 1e-9);
}

TEST(PrimitiveFit, OutliersDoNotMoveASphere)
{
  const auto cloud = Cap(0.05, 60);
  const auto sphere = FitSphere(cloud.points, cloud.weights);
  EXPECT_NEAR((sphere.centre - Vector3(5, -3, 8)).norm(), 0.0, 0.05);
  EXPECT_NEAR(sphere.radius, 20.0, 0.05);
  EXPECT_NEAR(sphere.deviation, 0.05, 0.01);
}

TEST(PrimitiveFit, ALineAndAPlaneMoveWithTheirPoints)
{
  std::mt19937                     random(9);
  std::normal_distribution<double> normal;
  const auto                       turn = Eigen::AngleAxisd(0.8, Vector3(3, 1, 2).normalized());
  Cloud                            line, plane;
  for (int i = 0; i < 200; ++i)
  {
    line.points.push_back(turn * Vector3(0.01 * normal(random), 0.01 * normal(random), i) + Vector3(7, 7, 7));
    plane.points.push_back(
      turn * Vector3(10 * normal(random), 8 * normal(random), i % 8 ? 0.01 * normal(random) : 2.0) + Vector3(1, 2, 3));
    line.weights.push_back(1.0);
    plane.weights.push_back(1.0);
  }
  const auto axis = FitLine(line.points, line.weights);
  EXPECT_NEAR(std::abs(axis.direction.dot(turn * Vector3::UnitZ())), 1.0, 1e-7);
  EXPECT_NEAR(axis.Distance(Vector3(7, 7, 7)), 0.0, 0.01);
  EXPECT_NEAR(axis.deviation, 0.014, 0.003);
  const auto face = FitPlane(plane.points, plane.weights);
  EXPECT_NEAR(std::abs(face.normal.dot(turn * Vector3::UnitZ())), 1.0, 1e-6);
  EXPECT_NEAR(face.normal.dot(Vector3(1, 2, 3) - face.point), 0.0, 0.01);
}

TEST(PrimitiveFit, AWeightOfTwoIsAPointTwice)
{
  auto cloud = Cap(0.3, 20);
  for (double & w : cloud.weights)
  {
    w = w > 1.2 ? 2.0 : 1.0;
  }
  Cloud twice;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
  {
    twice.points.insert(twice.points.end(), cloud.weights[i] > 1.5 ? 2 : 1, cloud.points[i]);
  }
  twice.weights.assign(twice.points.size(), 1.0);
  const auto a = FitSphere(cloud.points, cloud.weights), b = FitSphere(twice.points, twice.weights);
  EXPECT_NEAR((a.centre - b.centre).norm(), 0.0, 1e-8);
  EXPECT_NEAR(a.radius, b.radius, 1e-8);
}

TEST(PrimitiveFit, RefusesTooFewOrDegeneratePoints)
{
  const std::vector<Vector3> square = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 }, { 2, 0, 0 } };
  const std::vector<double>  ones(5, 1.0);
  EXPECT_THROW(FitSphere(square, ones), std::invalid_argument);
  EXPECT_THROW(FitSphere({ square[0] }, { 1.0 }), std::invalid_argument);
  EXPECT_THROW(FitSphere(square, { 1.0 }), std::invalid_argument);
  EXPECT_THROW(FitLine({ square[0], square[1] }, { 1.0, 0.0 }), std::invalid_argument);
  EXPECT_THROW(FitLine({ square.begin(), square.begin() + 4 }, { 1, 1, 1, 1 }), std::invalid_argument);
  EXPECT_THROW(FitPlane({ square[0], square[1], square[4] }, { 1, 1, 1 }), std::invalid_argument);
  EXPECT_NO_THROW(FitPlane(square, ones));
}
} // namespace PrimitiveFitTests
