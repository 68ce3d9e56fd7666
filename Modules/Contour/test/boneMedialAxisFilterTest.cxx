/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMedialAxisFilter.h"

#include "boneMedialAxis.h"

#include "boneContourTestTools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace bone
{
namespace MedialAxisFilterTests
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

MedialAxisFilter::Pointer
Updated(ContourStack * stack)
{
  auto filter = MedialAxisFilter::New();
  filter->SetInput(stack);
  filter->Update();
  return filter;
}

// Points along the branches, a tenth of a millimetre apart.
Polygon
DenseAlong(const std::vector<AxisBranch> & branches)
{
  Polygon points;
  for (const AxisBranch & branch : branches)
  {
    points.push_back(branch.points[0]);
    for (std::size_t i = 0; i + 1 < branch.points.size(); ++i)
    {
      const Vector2 d = branch.points[i + 1] - branch.points[i];
      for (double at = 0.1; at < d.norm(); at += 0.1)
      {
        points.push_back(branch.points[i] + at / d.norm() * d);
      }
      points.push_back(branch.points[i + 1]);
    }
  }
  return points;
}

// Largest distance from a point of `from` to the nearest of `to`.
double
LargestDistance(const Polygon & from, const Polygon & to)
{
  double largest = 0.0;
  for (const Vector2 & q : from)
  {
    double best = std::numeric_limits<double>::max();
    for (const Vector2 & p : to)
    {
      best = std::min(best, (p - q).norm());
    }
    largest = std::max(largest, best);
  }
  return largest;
}

// Samples 3 mm apart.
MedialAxisParameters
Pruned()
{
  MedialAxisParameters parameters;
  parameters.spacing = 3.0;
  return parameters;
}

// With nothing but the hairs of the polygon's own corners pruned.
MedialAxisParameters
Unpruned()
{
  MedialAxisParameters parameters;
  parameters.significance = 0.02;
  parameters.spacing = 0.4; // ends stop at a clearance of 0.2 mm
  return parameters;
}

// Whole axes, both ways, against the analytic ones: to 1 % of the shape's size.
TEST(MedialAxis, OfAnEllipseIsItsLongAxisBetweenTheCentresOfCurvature)
{
  const double  end = (400.0 - 64.0) / 20.0;
  const Polygon whole = DenseAlong({ { { { -end, 0 }, { end, 0 } }, {} } });
  const Polygon found = DenseAlong(ComputeMedialAxis({ Ellipse(20, 8, 400) }, Unpruned()));
  EXPECT_LT(LargestDistance(found, whole), 0.1);
  EXPECT_LT(LargestDistance(whole, found), 0.4);
  // Pruned as by default it is a part of that.
  EXPECT_LT(LargestDistance(DenseAlong(ComputeMedialAxis({ Ellipse(20, 8, 400) }, Pruned())), whole), 0.1);
}

TEST(MedialAxis, OfARoundedRectangleIsItsMiddleLineAndTheBisectorsOfItsCorners)
{
  // 40 by 10 mm, rounded by 1 mm: bisectors end in the corners' centres.
  std::vector<AxisBranch> whole(1, { { { -15, 0 }, { 15, 0 } }, {} });
  for (const double x : { -1.0, 1.0 })
  {
    for (const double y : { -1.0, 1.0 })
    {
      whole.push_back({ { { 15 * x, 0 }, { 19 * x, 4 * y } }, {} });
    }
  }
  MedialAxisParameters parameters = Unpruned();
  parameters.significance = 0.2;
  const Polygon found = DenseAlong(ComputeMedialAxis({ Rectangle(40, 10, 1.0) }, parameters));
  EXPECT_LT(LargestDistance(found, DenseAlong(whole)), 0.1);
  EXPECT_LT(LargestDistance(DenseAlong(whole), found), 0.4);
  // By default the corners are pruned.
  parameters.significance = 0.8;
  const auto branches = ComputeMedialAxis({ Rectangle(40, 10, 1.0) }, parameters);
  ASSERT_EQ(branches.size(), 1u);
  EXPECT_LT(LargestDistance(DenseAlong(branches), DenseAlong({ whole[0] })), 0.1);
  EXPECT_LT(LargestDistance(DenseAlong({ whole[0] }), DenseAlong(branches)), 0.4);
}

TEST(MedialAxis, OfALShapeHasAParabolaAboutTheInnerCorner)
{
  const Polygon corner = { { 0, 0 }, { 30, 0 }, { 30, 6 }, { 6, 6 }, { 6, 24 }, { 0, 24 } };
  // Legs, bisectors of the five convex corners, and the points as far from the inner corner (6, 6) as from an edge.
  const double            crossing = 6.0 * (2.0 - std::sqrt(2.0));
  std::vector<AxisBranch> whole = { { { { 6, 3 }, { 27, 3 } }, {} },
                                    { { { 3, 6 }, { 3, 21 } }, {} },
                                    { { { 27, 3 }, { 30, 0 } }, {} },
                                    { { { 27, 3 }, { 30, 6 } }, {} },
                                    { { { 3, 21 }, { 0, 24 } }, {} },
                                    { { { 3, 21 }, { 6, 24 } }, {} },
                                    { { { 0, 0 }, { crossing, crossing } }, {} } };
  AxisBranch              arcs[2];
  for (int i = 0; i <= 40; ++i)
  {
    const double x = crossing + (6.0 - crossing) * i / 40.0;
    const double y = ((x - 6.0) * (x - 6.0) + 36.0) / 12.0;
    arcs[0].points.emplace_back(x, y);
    arcs[1].points.emplace_back(y, x);
  }
  whole.insert(whole.end(), arcs, arcs + 2);
  const auto    branches = ComputeMedialAxis({ corner }, Unpruned());
  const Polygon found = DenseAlong(branches);
  EXPECT_LT(LargestDistance(found, DenseAlong(whole)), 0.1);
  EXPECT_LT(LargestDistance(DenseAlong(whole), found), 0.3);
  for (const AxisBranch & branch : branches)
  {
    ASSERT_EQ(branch.clearance.size(), branch.points.size());
    for (std::size_t i = 0; i < branch.points.size(); ++i)
    {
      EXPECT_TRUE(PointInPolygon(branch.points[i], corner));
      EXPECT_NEAR(branch.clearance[i], DistanceTo(branch.points[i], corner), 1e-9);
    }
  }
  EXPECT_LT(LargestDistance(DenseAlong(ComputeMedialAxis({ corner }, Pruned())), DenseAlong(whole)), 0.3);
}

TEST(MedialAxis, RunsOnceAroundEachHole)
{
  // A ring, and a plate with two holes: three links between two cycles' worth of branches.
  const auto ring = ComputeMedialAxis({ Ellipse(20, 20, 200), Ellipse(10, 10, 100) }, Pruned());
  ASSERT_EQ(ring.size(), 1u);
  EXPECT_EQ(ring[0].points.front(), ring[0].points.back());
  for (std::size_t i = 0; i < ring[0].points.size(); ++i)
  {
    EXPECT_NEAR(ring[0].points[i].norm(), 15.0, 0.01);
    EXPECT_NEAR(ring[0].clearance[i], 5.0, 0.01);
  }
  const auto plate =
    ComputeMedialAxis({ Rectangle(60, 30, 5), Ellipse(6, 6, 60, { -14, 0 }), Ellipse(6, 6, 60, { 14, 0 }) }, Pruned());
  std::map<std::pair<double, double>, int> nodes;
  std::size_t                              edges = 0;
  for (const AxisBranch & branch : plate)
  {
    edges += branch.points.size() - 1;
    for (const Vector2 & q : branch.points)
    {
      nodes.insert({ { q.x(), q.y() }, 0 });
    }
  }
  EXPECT_EQ(edges + 1 - nodes.size(), 2u);
}

TEST(MedialAxis, OfARoundSectionIsAPoint)
{
  const auto branches = ComputeMedialAxis({ Ellipse(10.5, 9.5, 80, { 100, -200 }) }, Pruned());
  ASSERT_EQ(branches.size(), 1u);
  ASSERT_EQ(branches[0].points.size(), 1u);
  EXPECT_NEAR((branches[0].points[0] - Vector2(100, -200)).norm(), 0.0, 0.6);
  EXPECT_NEAR(branches[0].clearance[0], 9.5, 0.1);
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
  const auto branches = ComputeMedialAxis({ star }, parameters);
  ASSERT_EQ(branches.size(), 3u);
  const Polygon & one = branches[0].points;
  const Polygon & two = branches[1].points;
  const Vector2   hub = one.front() == two.front() || one.front() == two.back() ? one.front() : one.back();
  for (const AxisBranch & branch : branches)
  {
    EXPECT_TRUE(branch.points.front() == hub || branch.points.back() == hub);
  }
  EXPECT_LT(hub.norm(), 0.1);
}

TEST(MedialAxisFilter, AddsTheInnermostLayerAndGoesAroundHoles)
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
      const bool around = contour.points[0].x() > 30.0;
      EXPECT_EQ(contour.layer, around ? 1 : 2);
      EXPECT_EQ(contour.region, around ? 1 : 2);
      EXPECT_EQ(contour.points.front() == contour.points.back(), around);
      EXPECT_EQ(contour.clearance.size(), contour.points.size());
    }
  }
  EXPECT_EQ(axes, 2);
  // Run again on its own output: axes are replaced, not added.
  EXPECT_EQ(Updated(filter->GetOutput())->GetOutput()->GetNumberOfContours(),
            filter->GetOutput()->GetNumberOfContours());
}

TEST(MedialAxisFilter, RefusesBadParameters)
{
  auto filter = MedialAxisFilter::New();
  filter->SetInput(OneSlice({ Ellipse(5, 5, 50) }, { 0 }));
  filter->SetSignificance(0.0);
  EXPECT_THAT(MessageOf([&] { filter->Update(); }), testing::HasSubstr("Significance"));
}
} // namespace MedialAxisFilterTests
} // namespace bone
