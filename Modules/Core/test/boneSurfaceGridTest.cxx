/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceGrid.h"

#include "boneTestBodies.h"
#include "boneTriangleTree.h"

#include <gtest/gtest.h>

using namespace bone;

TEST(TrianglesCross, SeesPiercingTouchingAndFolding)
{
  const std::vector<Vector3> p = { { 0, 0, 0 },     { 2, 0, 0 },   { 0, 2, 0 },    { 0.5, 0.5, -1 },
                                   { 0.5, 0.5, 1 }, { 3, 3, 0.5 }, { 2, 2, 0 },    { -1, -1, 0 },
                                   { 0.4, 0.4, 0 }, { 5, 5, 5 },   { 0.5, 0.5, 0 } };
  EXPECT_TRUE(TrianglesCross({ 0, 1, 2 }, { 3, 4, 5 }, p)) << "an edge goes through";
  EXPECT_FALSE(TrianglesCross({ 0, 1, 2 }, { 6, 5, 9 }, p));
  EXPECT_TRUE(TrianglesCross({ 0, 1, 2 }, { 10, 5, 9 }, p)) << "a point touches";
  EXPECT_FALSE(TrianglesCross({ 0, 1, 2 }, { 1, 2, 6 }, p)) << "in one plane, side by side";
  EXPECT_TRUE(TrianglesCross({ 0, 1, 2 }, { 1, 2, 8 }, p)) << "in one plane, folded over";
  EXPECT_FALSE(TrianglesCross({ 0, 1, 2 }, { 1, 2, 4 }, p)) << "on a common edge";
  EXPECT_FALSE(TrianglesCross({ 0, 1, 2 }, { 0, 7, 4 }, p)) << "at a common point";
  EXPECT_TRUE(TrianglesCross({ 0, 1, 2 }, { 0, 3, 4 }, p)) << "at a common point, and through";
  EXPECT_TRUE(TrianglesCross({ 0, 1, 2 }, { 2, 0, 1 }, p));
}

TEST(SurfaceGrid, AgreesWithTheAuditOfAllPairs)
{
  std::mt19937                           random(7);
  std::uniform_real_distribution<double> uniform(0, 10);
  std::vector<Vector3>                   points;
  std::vector<TriangleIds>               triangles;
  for (IdType i = 0; i < 60; ++i)
  {
    const Vector3 at(uniform(random), uniform(random), uniform(random));
    for (int k = 0; k < 3; ++k)
    {
      points.push_back(at + 0.2 * Vector3(uniform(random), uniform(random), uniform(random)));
    }
    triangles.push_back({ 3 * i, 3 * i + 1, 3 * i + 2 });
  }
  const auto pairs = FindCrossingTriangles(triangles, points);
  EXPECT_FALSE(pairs.empty());
  std::vector<std::array<int, 2>> expected;
  SurfaceGrid                     grid(1.0);
  for (int i = 0; i < 60; ++i)
  {
    bool any = false;
    for (int j = 0; j < i; ++j)
    {
      if (TrianglesCross(triangles[i], triangles[j], points))
      {
        expected.push_back({ j, i });
        any = true;
      }
    }
    EXPECT_EQ(grid.Crosses(triangles[i], -1, points), any);
    grid.Insert(triangles[i], points);
  }
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(pairs, expected);
  for (int i = 0; i < 59; ++i)
  {
    grid.Erase(triangles[i], points);
  }
  EXPECT_FALSE(grid.Crosses(triangles[0], -1, points));
  EXPECT_TRUE(grid.Crosses(triangles[59], -1, points));
  EXPECT_FALSE(grid.Crosses(triangles[59], triangles[59][0], points)) << "triangles of the ignored point do not count";
}

TEST(SurfaceGrid, FollowsPointsThatMove)
{
  std::mt19937                           random(11);
  std::uniform_real_distribution<double> uniform(-5, 5);
  const auto               place = [&] { return Vector3(uniform(random), uniform(random), uniform(random)); };
  std::vector<Vector3>     points;
  std::vector<TriangleIds> triangles;
  SurfaceGrid              grid(1.0);
  for (IdType i = 0; i < 60; ++i)
  {
    const Vector3 at = place();
    for (int k = 0; k < 3; ++k)
    {
      points.push_back(at + 0.2 * place());
    }
    triangles.push_back({ 3 * i, 3 * i + 1, 3 * i + 2 });
    grid.Insert(triangles.back(), points);
  }
  int crossings = 0;
  for (int i = 0; i < 600; ++i)
  {
    // Within a cell, into the next one, or anywhere.
    const IdType  p = static_cast<IdType>(random() % points.size());
    const Vector3 before = points[p];
    points[p] += (i % 3 == 0 ? 0.01 : i % 3 == 1 ? 0.2 : 1.0) * place();
    grid.Move(triangles[p / 3], p, before, points);
    const IdType q = static_cast<IdType>(random() % points.size());
    bool         any = false;
    for (const TriangleIds & t : triangles)
    {
      any = any || (t != triangles[q / 3] && TrianglesCross(triangles[q / 3], t, points));
    }
    EXPECT_EQ(grid.Crosses(triangles[q / 3], q, points), any);
    crossings += any ? 1 : 0;
  }
  EXPECT_GT(crossings, 50);
  EXPECT_LT(crossings, 550);
}

TEST(SurfaceGrid, LayeredBodiesDoNotCrossThemselves)
{
  const auto mesh = test::MakeBall(4, { 1, 2 }, 12, 0.15, 3);
  for (int region = 0; region <= 2; ++region)
  {
    EXPECT_TRUE(FindCrossingTriangles(BoundaryFaces(mesh, region), mesh.points).empty());
  }
}

TEST(TriangleTree, FindsWhatExhaustiveSearchFinds)
{
  const auto                          mesh = test::MakeBall(4, { 4 }, 10, 0.1, 1);
  std::vector<TriangleTree::Triangle> triangles;
  for (const auto & f : BoundaryFaces(mesh))
  {
    triangles.push_back({ mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]] });
  }
  const TriangleTree                     tree(triangles);
  std::mt19937                           random(4);
  std::uniform_real_distribution<double> uniform(-15, 15);
  for (int i = 0; i < 300; ++i)
  {
    const Vector3 x(uniform(random), uniform(random), uniform(random));
    double        best = 1e300;
    for (const auto & t : triangles)
    {
      best = std::min(best, (ClosestPointOnTriangle(x, t[0], t[1], t[2]) - x).squaredNorm());
    }
    const auto nearest = tree.FindNearest(x);
    EXPECT_DOUBLE_EQ(nearest.squaredDistance, best);
    EXPECT_TRUE(tree.IsWithin(x, best));
    EXPECT_FALSE(tree.IsWithin(x, best * (1 - 1e-9)));
    EXPECT_NEAR((nearest.point - x).squaredNorm(), best, 1e-12 * (1 + best));
    const auto & t = triangles[nearest.triangle];
    EXPECT_EQ(tree.GetTriangle(nearest.triangle), t);
    int near = static_cast<int>(random() % triangles.size());
    EXPECT_EQ(tree.FindSquaredDistance(x, near), nearest.squaredDistance);
    EXPECT_EQ(near, nearest.triangle);
    EXPECT_NEAR((ClosestPointOnTriangle(nearest.point, t[0], t[1], t[2]) - nearest.point).norm(), 0.0, 1e-12);
  }
  EXPECT_EQ(TriangleTree().FindNearest(Vector3::Zero()).triangle, -1);
}

TEST(TriangleTree, SegmentsAreTrianglesWithTwoEqualPoints)
{
  const TriangleTree tree({ { Vector3(0, 0, 0), Vector3(2, 0, 0), Vector3(2, 0, 0) } });
  EXPECT_NEAR((tree.FindNearest(Vector3(1, 1, 1)).point - Vector3(1, 0, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((tree.FindNearest(Vector3(3, 1, 0)).point - Vector3(2, 0, 0)).norm(), 0.0, 1e-15);
}
