/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneWallGuide.h"

#include "boneContourTiler.h"
#include "boneRingKnit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

namespace WallGuideTests
{
using bone::Vector2;
using bone::Vector3;
using namespace bone::tiling;

constexpr double Pi = 3.14159265358979323846;
constexpr int    Points = 72; // of a circle

/** Adds a circle's points, counter-clockwise. */
Walk
AddCircle(VertexPool & pool, const Vector2 & centre, double radius, double height)
{
  Walk walk;
  for (int i = 0; i < Points; ++i)
  {
    const double  t = 2 * Pi * i / Points;
    const Vector2 q = centre + radius * Vector2(std::cos(t), std::sin(t));
    walk.push_back(pool.Add(q, { q.x(), q.y(), height }, 0, 0));
  }
  return walk;
}

TEST(WallGuide, DistanceFromTheShapeBetweenTwoCircles)
{
  VertexPool      pool;
  const Walk      lower = AddCircle(pool, { 1, 2 }, 10, 5), upper = AddCircle(pool, { 1, 2 }, 8, 7);
  const WallGuide guide(pool, lower, upper);
  for (int i = 0; i < Points; ++i)
  {
    EXPECT_NEAR(guide.Departure(lower[i], upper[i]), 0.0, 1e-3);
    // Across a quarter of the circle: half-way it is to have a radius of 9 and a slope of 1.
    const double radius = 0.5 * std::hypot(10.0, 8.0);
    EXPECT_NEAR(guide.Departure(lower[i], upper[(i + Points / 4) % Points]), (9 - radius) / std::sqrt(2.0), 0.02);
    // Asked again, it says the same.
    EXPECT_EQ(guide.Departure(lower[i], upper[i]), guide.Departure(lower[i], upper[i]));
  }
  EXPECT_NEAR(guide.GetLimit(), 0.15 * (2 + 20 * std::sin(Pi / Points)), 1e-9);
}

TEST(WallGuide, WallsMayLeanAsAWhole)
{
  VertexPool      pool;
  const Walk      lower = AddCircle(pool, { 0, 0 }, 5, 0), upper = AddCircle(pool, { 4, 1 }, 5, 2);
  const WallGuide guide(pool, lower, upper);
  double          across = 0.0;
  for (int i = 0; i < Points; ++i)
  {
    EXPECT_NEAR(guide.Departure(lower[i], upper[i]), 0.0, 1e-9);
    across = std::max(across, guide.Departure(lower[i], upper[(i + Points / 2) % Points]));
  }
  EXPECT_GT(across, 4 * guide.GetLimit());
}

TEST(WallGuide, BridgesAndAxesBoundNothing)
{
  VertexPool pool;
  const Walk left = AddCircle(pool, { -12, 0 }, 10, 0), right = AddCircle(pool, { 12, 0 }, 10, 0);
  Walk       both = left; // from the left circle's rightmost point over to the right one's leftmost, round it, and back
  both.push_back(left[0]);
  for (int i = 0; i <= Points; ++i)
  {
    both.push_back(right[(Points / 2 + i) % Points]);
  }
  const Walk      upper = AddCircle(pool, { -12, 0 }, 10, 2);
  const WallGuide guide(pool, both, upper), alone(pool, left, upper);
  // Over the gap both contours are as far away as without the bridge.
  const int middle = pool.Add({ 0, 0 }, { 0, 0, 0 }, 0, 0);
  EXPECT_NEAR(guide.Departure(middle, middle), alone.Departure(middle, middle), 1e-9);
  EXPECT_GT(alone.Departure(middle, middle), 1.5);
  const Walk axis{ left[0], middle, right[0], middle };
  EXPECT_EQ(WallGuide(pool, axis, upper).Departure(left[0], upper[20]), 0.0);
}

/** A prism over an ellipse that turns with the height. */
struct TurningEllipse
{
  double rx, ry, turn, step;

  Vector2
  At(double t, double height) const
  {
    return Eigen::Rotation2Dd(turn * height / step) * Vector2(rx * std::cos(t), ry * std::sin(t));
  }

  bone::ContourStack::Pointer
  Stack(int slices, int points) const
  {
    bone::ContourStack::SliceContainer container;
    for (int k = 0; k < slices; ++k)
    {
      bone::ContourSlice slice;
      slice.origin = Vector3(0, 0, step * k);
      bone::Contour contour;
      contour.region = 1;
      for (int i = 0; i < points; ++i)
      {
        const Vector2 q = At(2 * Pi * (i + 0.37 * k) / points, step * k);
        contour.points.emplace_back(q.x(), q.y(), step * k);
      }
      slice.contours.push_back(contour);
      container.push_back(slice);
    }
    auto stack = bone::ContourStack::New();
    stack->SetSlices(container);
    return stack;
  }

  /** Distance of a point from the ellipse at its height, nearly. */
  double
  Distance(const Vector3 & p) const
  {
    double best = 1e9;
    for (int i = 0; i < 720; ++i)
    {
      best = std::min(best, (At(Pi * i / 360, p.z()) - p.head<2>()).norm());
    }
    return best;
  }
};

TEST(WallGuide, WallsOfATurningBoneStayNearItsSurface)
{
  struct Case
  {
    int    points;
    double turn, bound; ///< degrees from slice to slice; mm, where span length alone leaves twice as much and more
  };
  for (const Case & c : { Case{ 14, 10, 1.2 }, Case{ 16, 8, 1.0 }, Case{ 20, 6, 0.7 }, Case{ 24, 6, 0.5 } })
  {
    const TurningEllipse body{ 20, 7, c.turn * Pi / 180, 4 };
    bone::TilingReport   report;
    const auto           mesh = bone::TileContours(*body.Stack(4, c.points), {}, report);
    double               worst = 0.0;
    for (const auto & face : bone::BoundaryFaces(mesh))
    {
      for (int k = 0; k < 3; ++k)
      {
        const Vector3 middle = 0.5 * (mesh.points[face[k]] + mesh.points[face[(k + 1) % 3]]);
        if (middle.z() > 0 && middle.z() < 3 * body.step)
        {
          worst = std::max(worst, body.Distance(middle));
        }
      }
    }
    EXPECT_LT(worst, c.bound) << c.points << " points, turned by " << c.turn;
  }
}

/** A ring between two circles of as many points, triangulated alike all round. */
Merge
RadialRing()
{
  Merge ring;
  for (int i = 0; i < 2 * Points; ++i)
  {
    ring.letters.push_back(i % 2);
  }
  return ring;
}

TEST(WallGuide, AKnitSaysThatItsWallDeparts)
{
  VertexPool      pool;
  const Walk      outerLower = AddCircle(pool, { 0, 0 }, 20, 0), innerLower = AddCircle(pool, { 0, 0 }, 15, 0);
  const Walk      outerUpper = AddCircle(pool, { 0, 0 }, 20, 4), innerUpper = AddCircle(pool, { 0, 0 }, 15, 4);
  const Merge     ring = RadialRing();
  const RingPair  rings{ outerLower, innerLower, ring, outerUpper, innerUpper, ring };
  const WallGuide guide(pool, outerLower, outerUpper);
  for (const int twist : { 0, 4, 12, 19 }) // 5 degrees each, of the wall inside
  {
    Merge inner = RadialRing();
    inner.second = twist;
    Merge                   outer;
    std::vector<TiledTetra> tetrahedra;
    const RingKnit knit = KnitRing(pool, rings, inner, bone::SpanLengthMetric{}, guide, 0, 1, outer, tetrahedra);
    EXPECT_TRUE(knit.made) << twist;
    EXPECT_EQ(knit.departs, twist > 8) << twist;
  }
}
} // namespace WallGuideTests
