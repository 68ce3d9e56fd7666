/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneChordalAxis.h"

#include <gtest/gtest.h>

namespace ChordalAxisTests
{
using namespace bone;
using namespace bone::tiling;

/** A line of points along the middle of a strip 20 mm long and 4 mm wide. */
PlanarTree
LineTo(double end)
{
  PlanarTree tree{ { { 2, 2 }, { 6, 2 }, { 10, 2 }, { 14, 2 }, { end, 2 } }, {} };
  for (int i = 0; i < 4; ++i)
  {
    tree.edges.push_back({ { i, i + 1 } });
  }
  return tree;
}

const std::vector<Vector2> Strip = { { 0, 0 }, { 20, 0 }, { 20, 4 }, { 0, 4 } };

TEST(CarryAxis, CutsOffWhatLiesCloseToThePolygon)
{
  // Clearances are 2 mm at the most, and what has less than 0.3 of that goes.
  EXPECT_EQ(CarryAxis(LineTo(19.2), LineTo(19.2), Strip, 0.1).points.size(), 5u);
  EXPECT_EQ(CarryAxis(LineTo(19.6), LineTo(19.6), Strip, 0.1).points.size(), 4u);
}

TEST(CarryAxis, DrawsPointsTowardsTheTarget)
{
  PlanarTree target = LineTo(18);
  for (Vector2 & q : target.points)
  {
    q.y() = 3.0;
  }
  const PlanarTree carried = CarryAxis(LineTo(18), target, Strip, 0.1);
  ASSERT_EQ(carried.points.size(), 5u);
  EXPECT_NEAR(carried.points[2].y(), 2.35, 1e-12);
}

TEST(CarryAxis, IsNothingWhereEdgesBecomeTooShort)
{
  EXPECT_TRUE(CarryAxis(LineTo(18), LineTo(18), Strip, 4.5).points.empty());
}
} // namespace ChordalAxisTests
