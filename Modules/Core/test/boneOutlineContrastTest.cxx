/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOutlineContrast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace bone
{
namespace OutlineContrastTests
{
using testing::HasSubstr;
using testing::IsEmpty;

// Of 1,000 places `brighter` are brighter inside.
OutlineContrast
Outline(int brighter, double inside = 700.0, double outside = 40.0)
{
  OutlineContrast contrast;
  for (int k = 0; k < 1000; ++k)
  {
    contrast.Add(k < brighter ? inside : outside, k < brighter ? outside : inside, 1.0);
  }
  return contrast;
}

TEST(OutlineContrast, TellsAnOutlineThatIsNotTheBones)
{
  EXPECT_DOUBLE_EQ(Outline(640).GetBrighterShare(), 0.64);
  EXPECT_THAT(Outline(640).FindMismatch("mesh"), HasSubstr("Only 64 % of the bone's outline"));
  EXPECT_THAT(Outline(640).FindMismatch("mesh"), HasSubstr("do CT and mesh belong together?"));
  EXPECT_THAT(Outline(660).FindMismatch("mesh"), IsEmpty());
  EXPECT_THAT(Outline(0).FindMismatch("mesh"), HasSubstr("Only 0 %"));
}

TEST(OutlineContrast, EqualValuesAreNotBrighter)
{
  EXPECT_EQ(Outline(1000, 40.0, 40.0).GetBrighterShare(), 0.0);
}

TEST(OutlineContrast, PlacesCountByWhatTheyStandFor)
{
  OutlineContrast contrast = Outline(1000);
  contrast.Add(0.0, 100.0, 3000.0);
  EXPECT_DOUBLE_EQ(contrast.GetBrighterShare(), 0.25);
  contrast.Add(Outline(1000));
  EXPECT_DOUBLE_EQ(contrast.GetBrighterShare(), 0.4);
}

TEST(OutlineContrast, WhatIsNotFiniteOrTooLittleDoesNotTell)
{
  const double    nan = std::numeric_limits<double>::quiet_NaN();
  OutlineContrast contrast = Outline(1000);
  contrast.Add(nan, 0.0, 1e6);
  contrast.Add(0.0, nan, 1e6);
  EXPECT_DOUBLE_EQ(contrast.GetBrighterShare(), 1.0);
  OutlineContrast few;
  for (int k = 0; k < 99; ++k)
  {
    few.Add(2000.0, 3000.0, 1.0);
  }
  EXPECT_DOUBLE_EQ(few.GetBrighterShare(), 1.0);
  EXPECT_THAT(few.FindMismatch("mesh"), IsEmpty());
  EXPECT_THAT(few.FindForeignUnits(), IsEmpty());
  few.Add(2000.0, 3000.0, 1.0);
  EXPECT_DOUBLE_EQ(few.GetBrighterShare(), 0.0);
  EXPECT_THAT(few.FindForeignUnits(), HasSubstr("3000"));
}

TEST(OutlineContrast, TellsValuesThatAreNotHU)
{
  EXPECT_THAT(Outline(1000).FindForeignUnits(), IsEmpty());
  EXPECT_THAT(Outline(1000, 1700.0, 1064.0).FindForeignUnits(), HasSubstr("the CT has 1064 (median)"));
  EXPECT_THAT(Outline(1000, 255.0, 80.0).FindForeignUnits(), HasSubstr("reaches 255"));
  EXPECT_THAT(Outline(1000, 301.0, 399.0).FindForeignUnits(), IsEmpty());
  EXPECT_THAT(Outline(1000, 700.0, -1000.0).FindForeignUnits(), IsEmpty()); // a bone in air
}

TEST(OutlineContrast, LooksTwoVoxelsOutAndAtLeastThreeMillimetres)
{
  EXPECT_EQ(OutlineContrast::ReachOutside(0.5), 3.0);
  EXPECT_EQ(OutlineContrast::ReachOutside(3.0), 6.0);
}
} // namespace OutlineContrastTests
} // namespace bone
