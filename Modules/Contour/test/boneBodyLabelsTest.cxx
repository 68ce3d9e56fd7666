/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBodyLabels.h"

#include <gtest/gtest.h>

namespace bone
{
namespace
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

/** Area of the body of a block at the left of the image, on the slice after one that has it whole; the second has it
 * hollowed out from `left` to 12 mm. */
double
AreaOfHollowBlock(double left)
{
  const auto    isBlock = [](const Vector2 & q) { return q.x() < 20 && q.y() > 6 && q.y() < 24; };
  const auto    isHollow = [&](const Vector2 & q) { return q.x() > left && q.x() < 12 && q.y() > 11 && q.y() < 19; };
  BodyRules     rules;
  BodyTable     bodies(2); // none, and the one that is drawn
  const Polygon drawn = { { 0, 6 }, { 20, 6 }, { 20, 24 }, { 0, 24 } };
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
  EXPECT_NEAR(AreaOfHollowBlock(-1.0), 350 - 90, 1);
}
} // namespace
} // namespace bone
