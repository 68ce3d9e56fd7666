/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlaneField.h"

#include "boneContourTestTools.h"
#include "bonePlanarCrossing.h"

#include <gtest/gtest.h>

#include <random>

namespace bone
{
namespace PlaneFieldTests
{
PlaneGrid
Grid(int nx, int ny, const Vector2 & spacing)
{
  PlaneGrid grid;
  grid.size = { { nx, ny } };
  grid.origin = { -0.5 * (nx - 1) * spacing.x(), -0.5 * (ny - 1) * spacing.y() };
  grid.spacing = spacing;
  return grid;
}

template <typename TFunction>
PlaneField
Field(const PlaneGrid & grid, TFunction && f)
{
  PlaneField field{ grid, std::vector<float>(grid.Count()) };
  for (int j = 0; j < grid.size[1]; ++j)
  {
    for (int i = 0; i < grid.size[0]; ++i)
    {
      field.values[grid.Offset(i, j)] = static_cast<float>(f(grid.Node(i, j)));
    }
  }
  return field;
}

TEST(PlaneField, SamplesReproduceLinearAndCubicSamplesQuadraticFields)
{
  const PlaneGrid  grid = Grid(20, 16, { 0.7, 1.3 });
  const PlaneField linear = Field(grid, [](const Vector2 & q) { return 3.0 + 2.0 * q.x() - 0.5 * q.y(); });
  const PlaneField quadratic = Field(grid, [](const Vector2 & q) { return q.x() * q.x() - q.x() * q.y(); });
  const Vector2    q(1.234, -2.345);
  EXPECT_NEAR(linear.Sample(q), 3.0 + 2.0 * q.x() - 0.5 * q.y(), 1e-5);
  EXPECT_NEAR(linear.SampleCubic(q), 3.0 + 2.0 * q.x() - 0.5 * q.y(), 1e-5);
  EXPECT_NEAR(quadratic.SampleCubic(q), q.x() * q.x() - q.x() * q.y(), 1e-4);
  EXPECT_EQ(linear.Sample({ 1e6, 1e6 }), linear.values.at(grid.Offset(19, 15)));
}

TEST(PlaneField, LevelContoursOfARingAreAnOuterContourAndAHole)
{
  const PlaneGrid  grid = Grid(60, 50, { 0.5, 0.6 });
  const PlaneField field = Field(grid, [](const Vector2 & q) { return 2.0 - std::abs(q.norm() - 8.0); });
  const auto       contours = ExtractLevelContours(field, 0.0);
  ASSERT_EQ(contours.size(), 2u);
  double areas[2] = { SignedArea(contours[0]), SignedArea(contours[1]) };
  std::sort(areas, areas + 2);
  EXPECT_NEAR(areas[0], -M_PI * 36, 0.5);
  EXPECT_NEAR(areas[1], M_PI * 100, 1.0);
}

TEST(PlaneField, LevelContoursAreSimpleOnNoiseAndClosedAtTheBorder)
{
  std::mt19937                          random(3);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  PlaneField                            field{ Grid(40, 30, { 1, 1 }), {} };
  for (std::size_t n = 0; n < field.grid.Count(); ++n)
  {
    field.values.push_back(uniform(random));
  }
  std::vector<PlanarChain> chains;
  for (const Polygon & contour : ExtractLevelContours(field, 0.0))
  {
    ASSERT_GE(contour.size(), 4u);
    chains.push_back({ contour, true });
  }
  EXPECT_GT(chains.size(), 50u);
  EXPECT_FALSE(FindPlanarCrossing(chains).found);
  // All inside: one contour half a node beyond the border.
  std::fill(field.values.begin(), field.values.end(), 1.0F);
  const auto contours = ExtractLevelContours(field, 0.0);
  ASSERT_EQ(contours.size(), 1u);
  EXPECT_NEAR(SignedArea(contours[0]), 40.0 * 30.0, 1.0);
}

TEST(PlaneField, DistanceFieldMatchesTheExactDistance)
{
  const Polygon outer = Ellipse(12, 7, 200);
  const Polygon hole = [] {
    Polygon h = Ellipse(2, 2, 60, { 3, 0 });
    std::reverse(h.begin(), h.end());
    return h;
  }();
  const PlaneGrid     grid = Grid(60, 40, { 0.5, 0.5 });
  const DistanceField field = ComputeDistanceField({ outer, hole }, grid);
  double              largest = 0.0;
  for (int j = 0; j < grid.size[1]; ++j)
  {
    for (int i = 0; i < grid.size[0]; ++i)
    {
      const Vector2 q = grid.Node(i, j);
      const bool    inside = PointInPolygon(q, outer) && !PointInPolygon(q, hole);
      const double  exact = (inside ? 1.0 : -1.0) * std::min(DistanceTo(q, outer), DistanceTo(q, hole));
      largest = std::max(largest, std::abs(exact - field.distance.values[grid.Offset(i, j)]));
      EXPECT_EQ(field.polygon[grid.Offset(i, j)], DistanceTo(q, hole) < DistanceTo(q, outer) ? 1 : 0);
    }
  }
  EXPECT_LT(largest, 0.04); // of a spacing of 0.5
}

TEST(PlaneField, DistanceFieldStopsAtItsLimitAndHasNoneWithoutPolygons)
{
  const PlaneGrid grid = Grid(60, 60, { 0.5, 0.5 });
  const auto      near = ComputeDistanceField({ Ellipse(10, 10, 100) }, grid, 2.0);
  EXPECT_GT(near.distance.Sample({ 0, 0 }), 1e8);
  EXPECT_NEAR(near.distance.Sample({ 9, 0 }), 1.0, 0.02);
  EXPECT_EQ(ComputeDistanceField({}, grid).polygon[0], -1);
}

TEST(PlaneField, SmoothingKeepsTheMeanAndALinearField)
{
  PlaneField   field = Field(Grid(40, 40, { 0.5, 0.8 }), [](const Vector2 & q) { return 5.0 + q.x() - 2.0 * q.y(); });
  const double before = field.SampleCubic({ 0.3, -0.4 });
  SmoothField(field, 1.0);
  EXPECT_NEAR(field.SampleCubic({ 0.3, -0.4 }), before, 1e-4);
}

TEST(PlaneField, SmoothingAddsItsVarianceToAQuadraticField)
{
  const Vector2 middle(0.3, -0.4);
  for (const Vector2 & bend : { Vector2(1, 0), Vector2(0, 1), Vector2(2, 3) })
  {
    PlaneField field =
      Field(Grid(40, 40, { 0.5, 0.8 }), [&](const Vector2 & q) { return bend.dot((q - middle).cwiseAbs2()); });
    SmoothField(field, 1.2);
    // Kernels end at three standard deviations, where 2.7 % of the variance is left.
    EXPECT_NEAR(field.SampleCubic(middle), 1.2 * 1.2 * bend.sum(), 0.05 * bend.sum());
  }
}
} // namespace PlaneFieldTests
} // namespace bone
