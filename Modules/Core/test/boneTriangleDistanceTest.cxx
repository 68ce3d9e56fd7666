/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTriangleDistance.h"

#include "boneTestSurfaces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace bone;
using test::Box;
using test::BoxDistance;
using test::Shape;

TEST(TriangleDistance, IsExactForABox)
{
  const Vector3                          half(3.0, 5.0, 9.0);
  const Shape                            box = Box(half);
  const TriangleDistance                 distance(box.points, box.triangles);
  std::mt19937                           random(3);
  std::uniform_real_distribution<double> unit(-1.5, 1.5);
  EXPECT_NEAR(distance.GetVolume(), 8.0 * half.prod(), 1e-9);
  for (int n = 0; n < 5000; ++n)
  {
    const double  a = unit(random), b = unit(random), c = unit(random);
    const Vector3 x = half.cwiseProduct(Vector3(a, b, c));
    const auto    nearest = distance.FindNearest(x);
    EXPECT_NEAR(nearest.distance, BoxDistance(x, half), 1e-9);
    EXPECT_NEAR(nearest.gradient.norm(), 1.0, 1e-9);
    EXPECT_NEAR((x - nearest.distance * nearest.gradient - nearest.point).norm(), 0.0, 1e-9);
    const auto & t = distance.GetTriangles()[nearest.triangle];
    EXPECT_NEAR(
      (ClosestPointOnTriangle(x, box.points[t[0]], box.points[t[1]], box.points[t[2]]) - nearest.point).norm(),
      0.0,
      1e-9);
    EXPECT_TRUE(distance.IsWithin(x, std::abs(nearest.distance) * (1 + 1e-9) + 1e-9));
    EXPECT_FALSE(distance.IsWithin(x, std::abs(nearest.distance) * (1 - 1e-9) - 1e-9));
  }
  // Off an edge and off a corner, where a face's own normal could lie.
  EXPECT_NEAR(distance.FindNearest({ 4.0, 6.0, 1.0 }).distance, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(distance.FindNearest({ 4.0, 6.0, 10.0 }).distance, std::sqrt(3.0), 1e-12);
}

TEST(TriangleDistance, TurnsASurfaceThatLooksInward)
{
  Shape box = Box({ 1, 2, 3 });
  for (auto & t : box.triangles)
  {
    std::swap(t[0], t[1]);
  }
  const TriangleDistance distance(box.points, box.triangles);
  EXPECT_NEAR(distance.FindNearest(Vector3::Zero()).distance, -1.0, 1e-12);
  EXPECT_NEAR(distance.FindNearest({ 3, 0, 0 }).distance, 2.0, 1e-12);
}

TEST(TriangleTree, ASearchThatBeginsAtAnyTriangleFindsTheNearest)
{
  std::mt19937                           random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto                             place = [&] {
    const double a = unit(random), b = unit(random), c = unit(random);
    return Vector3(a, b, c);
  };
  std::vector<TriangleTree::Triangle> triangles;
  for (int n = 0; n < 150; ++n)
  {
    // In pairs that share an edge, which is often nearest in both.
    const Vector3 a = place(), b = a + 0.2 * place();
    triangles.push_back({ a, b, a + 0.2 * place() });
    triangles.push_back({ a, b, a + 0.2 * place() });
  }
  const TriangleTree tree(triangles);
  for (int n = 0; n < 500; ++n)
  {
    const Vector3 x = 1.5 * place();
    const auto    nearest = tree.FindNearest(x);
    for (int triangle : { -1, nearest.triangle, n % 300 })
    {
      EXPECT_EQ(tree.FindSquaredDistance(x, triangle), nearest.squaredDistance);
      EXPECT_EQ(triangle, nearest.triangle);
    }
  }
  int none = -1;
  TriangleTree().FindSquaredDistance({}, none);
  EXPECT_EQ(none, -1);
}
