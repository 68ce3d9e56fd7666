/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlanarOverlay.h"

#include "boneConstrainedTriangulation.h"
#include "bonePredicates.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace PlanarOverlayTests
{
using bone::Vector2;
using bone::tiling::BoxTriangulation;

BoxTriangulation
RandomBox(unsigned seed, int points)
{
  std::mt19937                           engine(seed);
  std::uniform_real_distribution<double> uniform(0.1, 9.9);
  bone::tiling::ConstrainedTriangulation triangulation({ 0, 0 }, { 10, 10 });
  for (int i = 0; i < points; ++i)
  {
    const double x = uniform(engine), y = uniform(engine);
    triangulation.Insert({ x, y });
  }
  BoxTriangulation box{ triangulation.GetPoints(), {} };
  for (const auto & t : triangulation.GetTriangles())
  {
    box.triangles.push_back(t.vertices);
  }
  return box;
}

double
Area(const std::vector<Vector2> & p, const std::array<int, 3> & t)
{
  const Vector2 d = p[t[1]] - p[t[0]], e = p[t[2]] - p[t[0]];
  return 0.5 * (d.x() * e.y() - d.y() * e.x());
}

TEST(PlanarOverlay, CoversEveryTriangleOfBothExactlyOnce)
{
  for (unsigned seed = 0; seed < 10; ++seed)
  {
    const BoxTriangulation boxes[2] = { RandomBox(2 * seed, 5 + 12 * static_cast<int>(seed)),
                                        RandomBox(2 * seed + 1, 60) };
    const auto             overlay = bone::tiling::Overlay(boxes[0], boxes[1], bone::Execution());
    for (int side = 0; side < 2; ++side)
    {
      std::vector<double> covered(boxes[side].triangles.size(), 0.0);
      for (const auto & t : overlay.triangles)
      {
        EXPECT_GT(
          bone::Orient2D(overlay.points[t.vertices[0]], overlay.points[t.vertices[1]], overlay.points[t.vertices[2]]),
          0);
        covered[side == 0 ? t.first : t.second] += Area(overlay.points, t.vertices);
      }
      for (std::size_t t = 0; t < covered.size(); ++t)
      {
        EXPECT_NEAR(covered[t], Area(boxes[side].points, boxes[side].triangles[t]), 1e-10);
      }
    }
    // A triangulated disk.
    std::set<std::array<int, 2>> edges;
    std::set<int>                vertices;
    for (const auto & t : overlay.triangles)
    {
      for (int i = 0; i < 3; ++i)
      {
        const int a = t.vertices[i], b = t.vertices[(i + 1) % 3];
        edges.insert({ { std::min(a, b), std::max(a, b) } });
        vertices.insert(a);
      }
    }
    EXPECT_EQ(static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) +
                static_cast<int>(overlay.triangles.size()),
              1);
    EXPECT_EQ(vertices.size(), overlay.points.size());
  }
}

TEST(PlanarOverlay, ChainsRunAlongTheirEdges)
{
  const BoxTriangulation boxes[2] = { RandomBox(7, 30), RandomBox(8, 30) };
  const auto             overlay = bone::tiling::Overlay(boxes[0], boxes[1], bone::Execution());
  for (int side = 0; side < 2; ++side)
  {
    for (const auto & [edge, chain] : overlay.chains[side])
    {
      EXPECT_EQ(chain.front(), overlay.vertexOf[side][edge[0]]);
      EXPECT_EQ(chain.back(), overlay.vertexOf[side][edge[1]]);
      double length = 0.0;
      for (std::size_t i = 1; i < chain.size(); ++i)
      {
        length += (overlay.points[chain[i]] - overlay.points[chain[i - 1]]).norm();
      }
      EXPECT_NEAR(length, (boxes[side].points[edge[0]] - boxes[side].points[edge[1]]).norm(), 1e-10);
    }
  }
}

TEST(PlanarOverlay, OfEmptyBoxesIsTheBox)
{
  const auto overlay = bone::tiling::Overlay(RandomBox(0, 0), RandomBox(0, 0), bone::Execution());
  EXPECT_EQ(overlay.points.size(), 4u);
  EXPECT_EQ(overlay.triangles.size(), 2u);
}

TEST(PlanarOverlay, RefusesVerticesInOnePlace)
{
  EXPECT_THROW(bone::tiling::Overlay(RandomBox(5, 10), RandomBox(5, 10), bone::Execution()), std::runtime_error);
}
} // namespace PlanarOverlayTests
