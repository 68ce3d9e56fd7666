/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneConstrainedTriangulation.h"

#include "bonePredicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ConstrainedTriangulationTests
{
using bone::Vector2;
using bone::tiling::ConstrainedTriangulation;

constexpr double Pi = 3.14159265358979323846;

double
TotalArea(const ConstrainedTriangulation & triangulation, const std::vector<char> * chosen = nullptr)
{
  double       area = 0.0;
  const auto & p = triangulation.GetPoints();
  const auto & triangles = triangulation.GetTriangles();
  for (std::size_t t = 0; t < triangles.size(); ++t)
  {
    const auto & v = triangles[t].vertices;
    EXPECT_GT(bone::Orient2D(p[v[0]], p[v[1]], p[v[2]]), 0);
    const Vector2 d = p[v[1]] - p[v[0]], e = p[v[2]] - p[v[0]];
    area += chosen == nullptr || (*chosen)[t] ? 0.5 * (d.x() * e.y() - d.y() * e.x()) : 0.0;
  }
  return area;
}

TEST(ConstrainedTriangulation, OfPointsAloneIsDelaunay)
{
  std::mt19937                           engine(3);
  std::uniform_real_distribution<double> uniform(-9.0, 9.0);
  ConstrainedTriangulation               triangulation({ -10, -10 }, { 10, 10 });
  for (int i = 0; i < 200; ++i)
  {
    const double x = uniform(engine), y = uniform(engine);
    EXPECT_EQ(triangulation.Insert({ x, y }), 4 + i);
  }
  EXPECT_EQ(triangulation.GetTriangles().size(), 2u * 200 + 2);
  EXPECT_NEAR(TotalArea(triangulation), 400.0, 1e-9);
  const auto & p = triangulation.GetPoints();
  for (const auto & t : triangulation.GetTriangles())
  {
    for (const Vector2 & q : p)
    {
      EXPECT_LE(bone::InCircle2D(p[t.vertices[0]], p[t.vertices[1]], p[t.vertices[2]], q), 0);
    }
  }
}

TEST(ConstrainedTriangulation, TakesGridPointsAndRepeatedOnes)
{
  ConstrainedTriangulation triangulation({ -1, -1 }, { 6, 6 });
  for (int i = 0; i < 36; ++i)
  {
    EXPECT_EQ(triangulation.Insert(Vector2(i % 6, i / 6)), 4 + i);
  }
  EXPECT_EQ(triangulation.Insert(Vector2(2, 3)), 4 + 20);
  EXPECT_NEAR(TotalArea(triangulation), 49.0, 1e-12);
}

TEST(ConstrainedTriangulation, PartsInsideFromOutsideOfAStarWithAHole)
{
  ConstrainedTriangulation      triangulation({ -20, -20 }, { 20, 20 });
  std::vector<std::vector<int>> loops(2);
  double                        area = 0.0;
  for (int loop = 0; loop < 2; ++loop)
  {
    std::vector<Vector2> points;
    for (int i = 0; i < 60; ++i)
    {
      const double angle = 2 * Pi * i / 60, radius = loop == 0 ? (i % 2 == 0 ? 15 : 5) : (i % 2 == 0 ? 4 : 1);
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
      loops[loop].push_back(triangulation.Insert(points.back()));
    }
    for (int i = 0; i < 60; ++i)
    {
      const Vector2 &a = points[i], &b = points[(i + 1) % 60];
      area += (loop == 0 ? 0.5 : -0.5) * (a.x() * b.y() - a.y() * b.x());
    }
  }
  for (const auto & loop : loops)
  {
    for (int i = 0; i < 60; ++i)
    {
      triangulation.Constrain(loop[i], loop[(i + 1) % 60]);
    }
  }
  EXPECT_NEAR(TotalArea(triangulation), 1600.0, 1e-9);
  const auto inside = triangulation.Inside();
  EXPECT_NEAR(TotalArea(triangulation, &inside), area, 1e-9);
}

TEST(ConstrainedTriangulation, SplitsASegmentAtVerticesOnIt)
{
  ConstrainedTriangulation triangulation({ -1, -1 }, { 6, 6 });
  const int                a = triangulation.Insert({ 0, 0 }), b = triangulation.Insert({ 5, 5 });
  triangulation.Insert({ 2, 2 });
  triangulation.Insert({ 3, 1 });
  triangulation.Constrain(a, b);
  int constrained = 0;
  for (const auto & t : triangulation.GetTriangles())
  {
    constrained += t.constrained[0] + t.constrained[1] + t.constrained[2];
  }
  EXPECT_EQ(constrained, 4); // two edges, each seen from both sides
}

TEST(ConstrainedTriangulation, RefusesSegmentsThatCross)
{
  ConstrainedTriangulation triangulation({ -1, -1 }, { 6, 6 });
  const int                a = triangulation.Insert({ 0, 0 }), b = triangulation.Insert({ 5, 4 });
  const int                c = triangulation.Insert({ 0, 4 }), d = triangulation.Insert({ 5, 0 });
  triangulation.Constrain(a, b);
  EXPECT_THROW(triangulation.Constrain(c, d), std::runtime_error);
}
} // namespace ConstrainedTriangulationTests
