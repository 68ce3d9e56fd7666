/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePredicates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace bone
{
namespace PredicatesTests
{
__extension__ typedef __int128 Wide;

int
Sign(Wide x)
{
  return (x > 0) - (x < 0);
}

// Points with whole coordinates that 128-bit arithmetic can judge exactly, many of them nearly or exactly degenerate.
class WholePoints
{
public:
  explicit WholePoints(unsigned int seed)
    : m_Random(seed)
  {}
  std::int64_t
  Number(std::int64_t size)
  {
    return std::uniform_int_distribution<std::int64_t>(-size, size)(m_Random);
  }
  template <int VDimension>
  std::array<std::int64_t, VDimension>
  Point(std::int64_t size)
  {
    std::array<std::int64_t, VDimension> p;
    for (auto & x : p)
    {
      x = Number(size);
    }
    return p;
  }

private:
  std::mt19937_64 m_Random;
};

Vector3
ToVector(const std::array<std::int64_t, 3> & p)
{
  return Vector3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
}

Vector2
ToVector(const std::array<std::int64_t, 2> & p)
{
  return Vector2(static_cast<double>(p[0]), static_cast<double>(p[1]));
}

TEST(Predicates, Orient3DIsPositiveForTheUnitTetrahedron)
{
  EXPECT_EQ(Orient3D({ 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }), 1);
  EXPECT_EQ(Orient3D({ 0, 0, 0 }, { 0, 1, 0 }, { 1, 0, 0 }, { 0, 0, 1 }), -1);
  EXPECT_EQ(Orient3D({ 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 }), 0);
}

TEST(Predicates, Orient3DAgreesWithWholeNumbers)
{
  WholePoints points(1);
  int         flat = 0;
  for (int trial = 0; trial < 20000; ++trial)
  {
    const std::int64_t size = trial % 2 == 0 ? 3 : std::int64_t{ 1 } << 38;
    const auto         a = points.Point<3>(size), b = points.Point<3>(size), c = points.Point<3>(size);
    auto               d = points.Point<3>(size);
    if (trial % 4 == 1)
    {
      // The fourth corner of a parallelogram, one unit off or not at all.
      for (int k = 0; k < 3; ++k)
      {
        d[k] = b[k] + c[k] - a[k];
      }
      d[trial % 3] += trial / 4 % 3 - 1;
    }
    Wide m[3][3];
    for (int k = 0; k < 3; ++k)
    {
      m[0][k] = b[k] - a[k];
      m[1][k] = c[k] - a[k];
      m[2][k] = d[k] - a[k];
    }
    const Wide exact = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    flat += exact == 0 ? 1 : 0;
    ASSERT_EQ(Orient3D(ToVector(a), ToVector(b), ToVector(c), ToVector(d)), Sign(exact)) << trial;
  }
  EXPECT_GT(flat, 500);
}

TEST(Predicates, Orient3DChangesSignWithEverySwap)
{
  std::mt19937                           random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 500; ++trial)
  {
    std::array<Vector3, 4> p;
    for (auto & q : p)
    {
      q = Vector3(unit(random), unit(random), trial % 2 == 0 ? unit(random) : 0.1);
    }
    const int sign = Orient3D(p[0], p[1], p[2], p[3]);
    for (int i = 0; i < 4; ++i)
    {
      for (int j = i + 1; j < 4; ++j)
      {
        auto q = p;
        std::swap(q[i], q[j]);
        EXPECT_EQ(Orient3D(q[0], q[1], q[2], q[3]), -sign);
      }
    }
  }
}

TEST(Predicates, SeeOneUlp)
{
  const double step = std::nextafter(0.3, 1.0);
  // 0.1, 0.1+0.2 and 0.3 are no whole multiples in binary: judged by what the doubles are.
  EXPECT_EQ(Orient3D({ 0, 0, 0.3 }, { 1, 0, 0.3 }, { 0, 1, 0.3 }, { 0.7, 0.9, 0.3 }), 0);
  EXPECT_EQ(Orient3D({ 0, 0, 0.3 }, { 1, 0, 0.3 }, { 0, 1, 0.3 }, { 0.7, 0.9, step }), 1);
  EXPECT_EQ(Orient3D({ 0, 0, step }, { 1, 0, step }, { 0, 1, step }, { 0.7, 0.9, 0.3 }), -1);
  EXPECT_EQ(Orient2D({ 0.5, 0.5 }, { 12, 12 }, { 24, 24 }), 0);
  EXPECT_EQ(Orient2D({ 0.5, 0.5 }, { 12, 12 }, { 24, std::nextafter(24.0, 25.0) }), 1);
  EXPECT_EQ(Orient2D({ std::nextafter(0.5, 1.0), 0.5 }, { 12, 12 }, { 24, 24 }), -1);
}

TEST(Predicates, VerySmallAndVeryLargeCoordinatesNeitherUnderflowNorLoseTheirSign)
{
  for (const double s : { 1e-150, 1e-110, 1e90 })
  {
    EXPECT_EQ(Orient3D({ 0, 0, 0 }, { s, 0, 0 }, { 0, s, 0 }, { 0, 0, s }), 1) << s;
    EXPECT_EQ(Orient3D({ 0, 0, 0 }, { 0, s, 0 }, { s, 0, 0 }, { 0, 0, s }), -1) << s;
    EXPECT_EQ(Orient2D({ 0, 0 }, { s, 0 }, { 0, s }), 1) << s;
  }
  const double tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(Orient2D({ 0, 0 }, { tiny, 0 }, { 0, tiny }), 1);
}

TEST(Predicates, Orient2DAndCrossSignAgreeWithWholeNumbers)
{
  WholePoints points(3);
  for (int trial = 0; trial < 20000; ++trial)
  {
    const std::int64_t size = trial % 2 == 0 ? 3 : std::int64_t{ 1 } << 50;
    const auto         a = points.Point<2>(size), b = points.Point<2>(size), c = points.Point<2>(size);
    const auto         d = points.Point<2>(size);
    const auto         cross = [](const auto & o, const auto & p, const auto & q, const auto & r) {
      return Wide(p[0] - o[0]) * (r[1] - q[1]) - Wide(p[1] - o[1]) * (r[0] - q[0]);
    };
    ASSERT_EQ(Orient2D(ToVector(a), ToVector(b), ToVector(c)), Sign(cross(a, b, a, c)));
    ASSERT_EQ(CrossSign2D(ToVector(a), ToVector(b), ToVector(c), ToVector(d)), Sign(cross(a, b, c, d)));
  }
}

TEST(Predicates, InCircleAgreesWithWholeNumbers)
{
  WholePoints points(4);
  int         cocircular = 0;
  for (int trial = 0; trial < 20000; ++trial)
  {
    const std::int64_t size = trial % 2 == 0 ? 4 : std::int64_t{ 1 } << 28;
    const auto         a = points.Point<2>(size), b = points.Point<2>(size), c = points.Point<2>(size);
    const auto         d = points.Point<2>(size);
    Wide               m[3][3];
    int                row = 0;
    for (const auto * p : { &a, &b, &c })
    {
      m[row][0] = (*p)[0] - d[0];
      m[row][1] = (*p)[1] - d[1];
      m[row][2] = m[row][0] * m[row][0] + m[row][1] * m[row][1];
      ++row;
    }
    const Wide exact = m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) +
                       m[1][2] * (m[2][0] * m[0][1] - m[2][1] * m[0][0]) +
                       m[2][2] * (m[0][0] * m[1][1] - m[0][1] * m[1][0]);
    cocircular += exact == 0 ? 1 : 0;
    ASSERT_EQ(InCircle2D(ToVector(a), ToVector(b), ToVector(c), ToVector(d)), Sign(exact)) << trial;
  }
  EXPECT_GT(cocircular, 100);
  EXPECT_EQ(InCircle2D({ 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, 0 }), 1);
  EXPECT_EQ(InCircle2D({ 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 }), 0);
  EXPECT_EQ(InCircle2D({ 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1.5 }), -1);
}
} // namespace PredicatesTests
} // namespace bone
