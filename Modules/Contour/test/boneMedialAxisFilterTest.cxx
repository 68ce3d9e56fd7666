/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMedialAxisFilter.h"

#include "boneContourTestTools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bone
{
namespace
{
Polygon
Rectangle(double width, double height, double rounding)
{
  Polygon      loop;
  const double centre[4][2] = { { 1, 1 }, { -1, 1 }, { -1, -1 }, { 1, -1 } };
  for (int corner = 0; corner < 4; ++corner)
  {
    for (int i = 0; i <= 8; ++i)
    {
      const double t = 0.5 * M_PI * (corner + i / 8.0);
      loop.push_back(
        Vector2(centre[corner][0] * (0.5 * width - rounding), centre[corner][1] * (0.5 * height - rounding)) +
        rounding * Vector2(std::cos(t), std::sin(t)));
    }
  }
  return loop;
}

MedialAxisFilter<>::Pointer
Updated(ContourStack * stack)
{
  auto filter = MedialAxisFilter<>::New();
  filter->SetInput(stack);
  filter->Update();
  return filter;
}

TEST(MedialAxis, OfARectangleIsItsMiddleLine)
{
  MedialAxisParameters parameters;
  parameters.spacing = 1.0;
  const auto branches = ComputeMedialAxis(Rectangle(40, 10, 1.0), parameters);
  ASSERT_EQ(branches.size(), 1u);
  double low = 0.0;
  double high = 0.0;
  for (const Vector2 & q : branches[0])
  {
    EXPECT_NEAR(q.y(), 0.0, 0.01);
    low = std::min(low, q.x());
    high = std::max(high, q.x());
  }
  // It ends where the corners' bisectors meet, 5 mm from the end.
  EXPECT_NEAR(low, -15.0, 0.5);
  EXPECT_NEAR(high, 15.0, 0.5);
}

TEST(MedialAxis, OfAnEllipseLiesOnItsLongAxis)
{
  MedialAxisParameters parameters;
  parameters.significance = 0.02;
  parameters.spacing = 1.0;
  const auto branches = ComputeMedialAxis(Ellipse(20, 8, 400), parameters);
  ASSERT_EQ(branches.size(), 1u);
  double high = 0.0;
  for (const Vector2 & q : branches[0])
  {
    EXPECT_NEAR(q.y(), 0.0, 0.05);
    high = std::max(high, std::abs(q.x()));
  }
  // Its ends are the centres of curvature, at (a^2 - b^2) / a.
  EXPECT_NEAR(high, (400.0 - 64.0) / 20.0, 0.4);
}

TEST(MedialAxis, OfARoundSectionIsAPoint)
{
  const auto branches = ComputeMedialAxis(Ellipse(10.5, 9.5, 80, { 100, -200 }), {});
  ASSERT_EQ(branches.size(), 1u);
  ASSERT_EQ(branches[0].size(), 1u);
  EXPECT_NEAR((branches[0][0] - Vector2(100, -200)).norm(), 0.0, 0.6);
}

TEST(MedialAxis, OfALShapeRunsAlongBothLegs)
{
  const Polygon        corner = { { 0, 0 }, { 30, 0 }, { 30, 6 }, { 6, 6 }, { 6, 24 }, { 0, 24 } };
  MedialAxisParameters parameters;
  parameters.spacing = 2.0;
  double right = 0.0;
  double up = 0.0;
  for (const AxisBranch & branch : ComputeMedialAxis(corner, parameters))
  {
    for (const Vector2 & q : branch)
    {
      EXPECT_TRUE(PointInPolygon(q, corner));
      right = std::max(right, q.x());
      up = std::max(up, q.y());
      if (q.x() > 10.0)
      {
        EXPECT_NEAR(q.y(), 3.0, 0.1);
      }
    }
  }
  EXPECT_NEAR(right, 27.0, 1.0);
  EXPECT_NEAR(up, 21.0, 1.0);
}

TEST(MedialAxis, BranchesShareTheirEndPoints)
{
  // A star of three arms.
  Polygon star;
  for (int i = 0; i < 360; ++i)
  {
    const double t = M_PI * i / 180.0;
    star.push_back((12.0 + 8.0 * std::cos(3 * t)) * Vector2(std::cos(t), std::sin(t)));
  }
  MedialAxisParameters parameters;
  parameters.spacing = 2.0;
  const auto branches = ComputeMedialAxis(star, parameters);
  ASSERT_EQ(branches.size(), 3u);
  const Vector2 hub = branches[0].front() == branches[1].front() || branches[0].front() == branches[1].back()
                        ? branches[0].front()
                        : branches[0].back();
  for (const AxisBranch & branch : branches)
  {
    EXPECT_TRUE(branch.front() == hub || branch.back() == hub);
  }
  EXPECT_LT(hub.norm(), 0.1);
}

TEST(MedialAxisFilter, AddsTheInnermostLayerOnly)
{
  Polygon hole = Ellipse(3, 3, 40, { 60, 0 });
  std::reverse(hole.begin(), hole.end());
  const auto stack =
    OneSlice({ Ellipse(20, 12, 120), Ellipse(16, 8, 100), Ellipse(10, 10, 80, { 60, 0 }), hole }, { 0, 1, 0, 0 });
  const auto filter = Updated(stack);
  int        axes = 0;
  for (const Contour & contour : filter->GetOutput()->GetSlices()[0].contours)
  {
    if (contour.axis)
    {
      ++axes;
      EXPECT_EQ(contour.layer, 2);
      EXPECT_EQ(contour.region, 2);
      EXPECT_LT(contour.points[0].x(), 30.0);
    }
  }
  EXPECT_EQ(axes, 1);
  // Run again on its own output: axes are replaced, not added.
  EXPECT_EQ(Updated(filter->GetOutput())->GetOutput()->GetNumberOfContours(),
            filter->GetOutput()->GetNumberOfContours());
}

TEST(MedialAxisFilter, RefusesBadParameters)
{
  auto filter = MedialAxisFilter<>::New();
  filter->SetInput(OneSlice({ Ellipse(5, 5, 50) }, { 0 }));
  filter->SetSignificance(0.0);
  EXPECT_THAT(MessageOf([&] { filter->Update(); }), testing::HasSubstr("Significance"));
}
} // namespace
} // namespace bone
