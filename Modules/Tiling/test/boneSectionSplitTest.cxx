/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionSplit.h"

#include "boneEllipseStack.h"
#include "boneSectionBuilder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace SectionSplitTests
{
using bone::Vector2;
using namespace bone::tiling;

using Triangles = std::vector<std::array<int, 4>>;

/** The triangles of sections with their regions, each from its smallest vertex. */
Triangles
SortedTriangles(const std::vector<Section> & sections)
{
  Triangles triangles;
  for (const Section & section : sections)
  {
    for (const PlanarTriangle & t : SectionTriangles(section))
    {
      auto v = t.vertices;
      std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
      triangles.push_back({ { v[0], v[1], v[2], t.region } });
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

/** A layered oval on the first of two slices. */
class SectionSplit : public ::testing::Test
{
protected:
  SectionSplit()
  {
    const std::vector<bone::Loop> oval = { { { 0, 0 }, 20, 9, 0, 1 }, { { 0, 0 }, 16, 6, 1, 2 } };
    const auto                    stack = bone::MakeStack({ oval, oval }, 3.0, 48);
    bone::TilingReport            report;
    const auto                    pieces = CollectPieces(*stack, 0, {}, report);
    m_Section = BuildSection(
      *stack, pieces.front(), {}, CarriedTolerance, 0, stack->GetHeight(0), m_Pool, report, bone::Execution());
  }

  static std::vector<Vector2>
  Circle(double x, double radius)
  {
    std::vector<Vector2> circle;
    for (int i = 0; i < 40; ++i)
    {
      const double t = 2 * bone::Pi * i / 40;
      circle.emplace_back(x + radius * std::cos(t), radius * std::sin(t));
    }
    return circle;
  }

  VertexPool m_Pool;
  Section    m_Section;
};

TEST_F(SectionSplit, PartsHaveAllTrianglesEachOnce)
{
  std::vector<Section> parts;
  CutTrace             cuts;
  for (const auto & places : { std::vector<double>{ -10, 10 }, { -13, 0, 13 }, { 14, -15, 5, -5 } })
  {
    std::vector<std::vector<Vector2>> counterparts;
    for (double x : places)
    {
      counterparts.push_back(Circle(x, 3));
    }
    ASSERT_TRUE(SplitSection(m_Pool.plane, m_Section, counterparts, {}, cuts, parts));
    ASSERT_EQ(parts.size(), places.size());
    EXPECT_EQ(SortedTriangles(parts), SortedTriangles({ m_Section }));
    for (std::size_t i = 0; i < parts.size(); ++i)
    {
      // Its triangles lie nearest to its counterpart, but for some at the cuts.
      int near = 0, all = 0;
      for (const PlanarTriangle & t : SectionTriangles(parts[i]))
      {
        const Vector2 q =
          (m_Pool.plane[t.vertices[0]] + m_Pool.plane[t.vertices[1]] + m_Pool.plane[t.vertices[2]]) / 3.0;
        double mean = 0.0;
        for (double x : places)
        {
          mean += x / static_cast<double>(places.size());
        }
        const auto nearest = std::min_element(places.begin(), places.end(), [&](double x, double y) {
          return (q - Vector2(x - mean, 0)).norm() < (q - Vector2(y - mean, 0)).norm();
        });
        near += nearest - places.begin() == static_cast<std::ptrdiff_t>(i);
        ++all;
      }
      EXPECT_GT(near, 0.7 * all) << places.size() << " counterparts, part " << i;
    }
  }
}

TEST_F(SectionSplit, ACutKeepsOffThoseOfTheOtherSide)
{
  const std::vector<std::vector<Vector2>> counterparts = { Circle(-10, 3), Circle(10, 3) };
  std::vector<Section>                    parts;
  CutTrace                                first, second;
  ASSERT_TRUE(SplitSection(m_Pool.plane, m_Section, counterparts, {}, first, parts));
  EXPECT_EQ(first.edges.size(), 4U); // in through two rings and out again
  EXPECT_EQ(first.vertices.size(), 3U);
  ASSERT_TRUE(SplitSection(m_Pool.plane, m_Section, counterparts, first, second, parts));
  for (int v : second.vertices)
  {
    EXPECT_EQ(first.vertices.count(v), 0U);
  }
  EXPECT_EQ(SortedTriangles(parts), SortedTriangles({ m_Section }));
}

TEST_F(SectionSplit, RefusesWhatHasNoRings)
{
  std::vector<Section> parts;
  CutTrace             cuts;
  Section              patch = m_Section, ring = m_Section;
  patch.patch = SectionTriangles(m_Section);
  ring.hole = true;
  EXPECT_FALSE(SplitSection(m_Pool.plane, patch, { Circle(-10, 3), Circle(10, 3) }, {}, cuts, parts));
  EXPECT_FALSE(SplitSection(m_Pool.plane, ring, { Circle(-10, 3), Circle(10, 3) }, {}, cuts, parts));
}
} // namespace SectionSplitTests
