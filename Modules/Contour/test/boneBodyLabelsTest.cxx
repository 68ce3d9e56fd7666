/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBodyLabels.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace bone
{
namespace BodyLabelsTests
{
/** 900 HU where there is bone, 0 elsewhere, on 30 x 30 mm from the origin. */
PlaneField
PlaneOfBone(const std::function<bool(const Vector2 &)> & isBone)
{
  PlaneField plane;
  plane.grid = { { { 60, 60 } }, { 0.0, 0.0 }, { 0.5, 0.5 } };
  for (int j = 0; j < 60; ++j)
  {
    for (int i = 0; i < 60; ++i)
    {
      plane.values.push_back(isBone(plane.grid.Node(i, j)) ? 900.0F : 0.0F);
    }
  }
  return plane;
}

/** Area of the body of a block at one border of the image, on the slice after one that has it whole; the second has it
 * hollowed out from `left` to 12 mm from there. Border: 0 the first column, 1 the first row, 2 the last column, 3 the
 * last row. */
double
AreaOfHollowBlock(double left, int border = 0)
{
  const auto fromBorder = [border](const Vector2 & q) -> Vector2 {
    const Vector2 p = border % 2 == 0 ? q : Vector2(q.y(), q.x());
    return { border < 2 ? p.x() : 29.5 - p.x(), p.y() };
  };
  const auto isBlock = [&](const Vector2 & q) {
    const Vector2 p = fromBorder(q);
    return p.x() < 20 && p.y() > 6 && p.y() < 24;
  };
  const auto isHollow = [&](const Vector2 & q) {
    const Vector2 p = fromBorder(q);
    return p.x() > left && p.x() < 12 && p.y() > 11 && p.y() < 19;
  };
  BodyRules rules;
  BodyTable bodies(2); // none, and the one that is drawn
  Polygon   drawn = { { 0, 6 }, { 20, 6 }, { 20, 24 }, { 0, 24 } };
  for (Vector2 & q : drawn)
  {
    q.x() = border < 2 ? q.x() : 29.5 - q.x();
    q = border % 2 == 0 ? q : Vector2(q.y(), q.x());
  }
  if (border == 1 || border == 2)
  {
    std::reverse(drawn.begin(), drawn.end()); // a mirrored polygon runs the other way
  }
  std::vector<BodyContact> contacts;
  const auto first = BodyLabels::FromDrawing(PlaneOfBone(isBlock), { { drawn, {}, {}, {} } }, rules, bodies);
  const auto second = BodyLabels::Continue(
    PlaneOfBone([&](const Vector2 & q) { return isBlock(q) && !isHollow(q); }), first, rules, bodies, contacts);
  return second.Area([](int body) { return body == 1; });
}

TEST(BodyLabels, WhatIsEnclosedBelongsToTheBodyThatHadIt)
{
  EXPECT_NEAR(AreaOfHollowBlock(4.0), 350, 1);
}

TEST(BodyLabels, WhatOpensToTheImagesBorderDoesNotThoughTheBodyHadIt)
{
  for (int border = 0; border < 4; ++border)
  {
    EXPECT_NEAR(AreaOfHollowBlock(4.0, border), 350, 10) << border;
    EXPECT_NEAR(AreaOfHollowBlock(-1.0, border), 350 - 90, 10) << border;
  }
}
} // namespace BodyLabelsTests
} // namespace bone
