/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourShape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace bone;

namespace ContourShapeTests
{
constexpr int Around = 256;

Contour
Circle(const Vector3 & centre, double radius, int region, bool clockwise = false)
{
  Contour contour;
  contour.region = region;
  for (int i = 0; i < Around; ++i)
  {
    const double angle = 2.0 * std::acos(-1.0) * i / Around;
    contour.points.push_back(centre + radius * Vector3(std::cos(angle), std::sin(angle), 0));
  }
  if (clockwise)
  {
    std::reverse(contour.points.begin(), contour.points.end());
  }
  return contour;
}

/** A cone of two layers with a hole through the inner one; radii 10 + z / 2 and 6, hole 2. */
ContourShape
Cone()
{
  ContourStack::SliceContainer slices;
  for (double z : { 0.0, 2.0, 6.0 })
  {
    ContourSlice slice;
    slice.origin = Vector3(0, 0, z);
    slice.contours = { Circle(slice.origin, 10 + 0.5 * z, Region::Cortical),
                       Circle(slice.origin, 6, Region::Trabecular),
                       Circle(slice.origin, 2, Region::Outside, true) };
    slices.push_back(slice);
  }
  auto stack = ContourStack::New();
  stack->SetSlices(slices);
  return ContourShape(*stack);
}

TEST(ContourShape, IsTheDistanceOnSlicesAndLinearBetween)
{
  const ContourShape shape = Cone();
  for (double z : { 0.0, 1.0, 2.0, 3.7, 6.0 })
  {
    for (double r : { 8.0, 10.2, 12.5, 14.0 })
    {
      const auto value = shape.Evaluate(1, { 0.6 * r, 0.8 * r, z });
      ASSERT_TRUE(value) << z;
      EXPECT_NEAR(value->distance, r - (10 + 0.5 * z), 2e-3);
      EXPECT_NEAR((value->gradient - Vector3(0.6, 0.8, -0.5)).norm(), 0.0, 0.03);
    }
  }
}

TEST(ContourShape, LevelsHaveWhatLiesWithinAndHolesAreOutsideOfAll)
{
  const ContourShape shape = Cone();
  EXPECT_NEAR(shape.Evaluate(2, { 5.0, 0, 1 })->distance, -1.0, 2e-3);
  EXPECT_NEAR(shape.Evaluate(2, { 7.0, 0, 1 })->distance, 1.0, 2e-3);
  for (int level : { 1, 2 })
  {
    EXPECT_NEAR(shape.Evaluate(level, { 1.5, 0, 1 })->distance, 0.5, 2e-3);
    EXPECT_NEAR(shape.Evaluate(level, { 2.5, 0, 1 })->distance, -0.5, 2e-3);
    EXPECT_LT(shape.Evaluate(level, { 2.5, 0, 1 })->gradient.x(), 0.0);
  }
}

TEST(ContourShape, InsideIsNegativeWithAnyNumberOfContoursBesideEachOther)
{
  for (int count = 1; count <= 3; ++count)
  {
    ContourStack::SliceContainer slices(2);
    slices[1].origin = Vector3(0, 0, 2);
    for (ContourSlice & slice : slices)
    {
      for (int i = 0; i < count; ++i)
      {
        slice.contours.push_back(Circle(slice.origin + Vector3(30 * i, 0, 0), 5, Region::Cortical));
      }
    }
    auto stack = ContourStack::New();
    stack->SetSlices(slices);
    const ContourShape shape(*stack);
    for (int i = 0; i < count; ++i)
    {
      EXPECT_NEAR(shape.Evaluate(1, { 30.0 * i + 3, 0, 1 })->distance, -2.0, 2e-3) << count;
      EXPECT_NEAR(shape.Evaluate(1, { 30.0 * i + 7, 0, 1 })->distance, 2.0, 2e-3) << count;
    }
  }
}

TEST(ContourShape, SamplesLieOnTheContoursOfTheirLevelAndLookOut)
{
  const ContourShape shape = Cone();
  EXPECT_EQ(shape.GetLevels(), 2);
  const double turn = 2.0 * std::acos(-1.0);
  // Radii of the outer contour are 10, 11, 13, of the hole 2, of the second level 6; slices stand for 1, 3 and 2 mm.
  const double length[3] = { 0.0, turn * (34 + 3 * 2), turn * (3 * 6 + 3 * 2) };
  const double area[3] = { 0.0, turn * (10 * 1 + 11 * 3 + 13 * 2 + 2 * 6), turn * (6 + 2) * 6 };
  for (int level : { 1, 2 })
  {
    double     sum = 0.0;
    const auto samples = shape.SampleContours(level, 0.5);
    for (const auto & sample : samples)
    {
      const double r = std::hypot(sample.place.x(), sample.place.y());
      const double exact = r < 4 ? 2.0 : level == 2 ? 6.0 : 10.0 + 0.5 * sample.place.z();
      EXPECT_NEAR(r, exact, 2e-3);
      EXPECT_NEAR(sample.outward.dot(sample.place) / r, r < 4 ? -1.0 : 1.0, 1e-3);
      EXPECT_NEAR(shape.Evaluate(level, sample.place)->distance, 0.0, 1e-9);
      sum += sample.weight;
    }
    EXPECT_NEAR(shape.GetContourLength(level), length[level], 1e-3 * length[level]);
    EXPECT_NEAR(sum, area[level], 1e-3 * area[level]);
    EXPECT_NEAR(static_cast<double>(samples.size()), length[level] / 0.5, 6.0);
  }
  EXPECT_TRUE(shape.SampleContours(3, 0.5).empty());
  EXPECT_TRUE(shape.SampleContours(0, 0.5).empty());
}

TEST(ContourShape, IsUnknownBeyondTheSlicesAndWithoutTheLevel)
{
  const ContourShape shape = Cone();
  EXPECT_FALSE(shape.Evaluate(1, { 0, 0, -0.1 }));
  EXPECT_FALSE(shape.Evaluate(1, { 0, 0, 6.1 }));
  EXPECT_FALSE(shape.Evaluate(3, { 0, 0, 1 }));
  EXPECT_FALSE(shape.Evaluate(0, { 0, 0, 1 }));
  EXPECT_FALSE(ContourShape(*ContourStack::New()).Evaluate(1, { 0, 0, 0 }));
}
} // namespace ContourShapeTests
