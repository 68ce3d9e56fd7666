/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourStack.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace bone
{
namespace ContourStackTests
{
using testing::HasSubstr;

std::vector<Vector2>
Circle(double radius, int n, const Vector2 & centre = Vector2::Zero())
{
  std::vector<Vector2> points;
  for (int i = 0; i < n; ++i)
  {
    const double t = 2.0 * M_PI * i / n;
    points.push_back(centre + radius * Vector2(std::cos(t), std::sin(t)));
  }
  return points;
}

// A stack of `count` equal slices on an oblique frame.
ContourStack::Pointer
MakeStack(const std::vector<std::vector<Vector2>> & loops, int count = 3)
{
  auto stack = ContourStack::New();
  stack->SetFrame({ 1, 2, 0.5 }, { -1, 1, 0.3 });
  ContourStack::SliceContainer slices;
  for (int k = 0; k < count; ++k)
  {
    ContourSlice slice;
    const double height = 10.0 + 2.0 * k;
    slice.origin = height * stack->GetNormal();
    for (std::size_t c = 0; c < loops.size(); ++c)
    {
      Contour contour;
      contour.id = static_cast<int>(c);
      contour.layer = static_cast<int>(c);
      for (const Vector2 & q : loops[c])
      {
        contour.points.push_back(stack->FromPlane(q, height));
      }
      slice.contours.push_back(contour);
    }
    slices.push_back(slice);
  }
  stack->SetSlices(std::move(slices));
  return stack;
}

void
ExpectRefused(ContourStack * stack, const std::function<void(ContourStack::SliceContainer &)> & spoil, const char * why)
{
  auto slices = stack->GetSlices();
  spoil(slices);
  stack->SetSlices(slices);
  try
  {
    stack->Verify();
    FAIL() << "not refused: " << why;
  }
  catch (const itk::ExceptionObject & error)
  {
    EXPECT_THAT(error.GetDescription(), HasSubstr(why));
  }
}

TEST(ContourStack, FrameIsRightHandedAndPlaneCoordinatesInvert)
{
  const auto stack = MakeStack({ Circle(5, 20) });
  EXPECT_NEAR(stack->GetU().dot(stack->GetV()), 0.0, 1e-15);
  EXPECT_NEAR(stack->GetU().norm(), 1.0, 1e-15);
  EXPECT_NEAR((stack->GetU().cross(stack->GetV()) - stack->GetNormal()).norm(), 0.0, 1e-15);
  const Vector3 p(3.5, -7.25, 11.0);
  EXPECT_NEAR((stack->FromPlane(stack->ToPlane(p), p.dot(stack->GetNormal())) - p).norm(), 0.0, 1e-13);
  EXPECT_DOUBLE_EQ(stack->GetHeight(1), 12.0);
}

TEST(ContourStack, FrameRefusesParallelAndNonFiniteAxes)
{
  auto stack = ContourStack::New();
  EXPECT_THROW(stack->SetFrame({ 1, 2, 3 }, { 2, 4, 6 }), itk::ExceptionObject);
  EXPECT_THROW(stack->SetFrame({ 0, 0, 0 }, { 1, 0, 0 }), itk::ExceptionObject);
  EXPECT_THROW(stack->SetFrame({ 1, 0, 0 }, { 0, std::nan(""), 0 }), itk::ExceptionObject);
}

TEST(ContourStack, VerifyAcceptsNestedCirclesAndAxes)
{
  const auto stack = MakeStack({ Circle(5, 200), Circle(4, 150), Circle(1, 30, { 2, 0 }) });
  EXPECT_NO_THROW(stack->Verify());
  EXPECT_EQ(stack->GetNumberOfContours(), 9u);
  auto slices = stack->GetSlices();
  // Two branches of an axis that share a point, and an axis of a single point.
  for (double angle : { 0.3, 1.2, 2.0 })
  {
    Contour axis;
    axis.axis = true;
    axis.points = { slices[1].origin,
                    slices[1].origin + 0.5 * (std::cos(angle) * stack->GetU() + std::sin(angle) * stack->GetV()) };
    slices[1].contours.push_back(axis);
  }
  slices[1].contours.push_back(slices[1].contours.back());
  slices[1].contours.back().points.resize(1);
  stack->SetSlices(slices);
  EXPECT_NO_THROW(stack->Verify());
}

TEST(ContourStack, VerifyNamesSliceAndContour)
{
  const auto make = [] { return MakeStack({ Circle(5, 40), Circle(4, 40) }); };
  ExpectRefused(
    make(), [](auto & s) { std::swap(s[0], s[1]); }, "Slice 1");
  ExpectRefused(
    make(), [](auto & s) { s[2].contours[1].points.resize(2); }, "contour 1 (layer 1) of slice 2");
  ExpectRefused(
    make(), [](auto & s) { std::swap(s[1].contours[0].points[3], s[1].contours[0].points[4]); }, "itself");
  ExpectRefused(
    make(), [](auto & s) { s[1].contours[1].points[3] *= 2.0; }, "off the slice's plane");
  ExpectRefused(
    make(), [](auto & s) { s[0].contours[0].points[0].x() = std::numeric_limits<double>::infinity(); }, "not finite");
  ExpectRefused(
    make(), [](auto & s) { s[0].contours[0].points[1] = s[0].contours[0].points[0]; }, "repeats a point (point 0)");
  ExpectRefused(
    make(), [](auto & s) { s[0].contours[0].points[1] = s[0].contours[0].points[20]; }, "crosses or touches");
}

TEST(ContourStack, VerifyFindsContoursThatMerelyTouch)
{
  // A vertex exactly on another contour's edge, seen along the axes where coordinates are exact.
  auto         stack = ContourStack::New();
  ContourSlice slice;
  Contour      square;
  square.points = { { 0, 0, 0 }, { 4, 0, 0 }, { 4, 4, 0 }, { 0, 4, 0 } };
  Contour triangle;
  triangle.id = 1;
  triangle.points = { { 2, 0, 0 }, { 3, 2, 0 }, { 1, 2, 0 } };
  slice.contours = { square, triangle };
  stack->SetSlices({ slice });
  EXPECT_THROW(stack->Verify(), itk::ExceptionObject);
  slice.contours[1].points[0].y() = std::numeric_limits<double>::min();
  stack->SetSlices({ slice });
  EXPECT_NO_THROW(stack->Verify());
}

TEST(ContourStack, VerifyAgreesWithBruteForceOnRandomPolygons)
{
  std::mt19937                           random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int                                    bad = 0;
  for (int trial = 0; trial < 200; ++trial)
  {
    auto loop = Circle(10, 24);
    for (Vector2 & q : loop)
    {
      q *= 0.3 + uniform(random); // star-shaped: simple
    }
    if (trial % 2 == 1)
    {
      std::swap(loop[static_cast<std::size_t>(24 * uniform(random))], loop[0]);
    }
    bool crosses = false;
    for (int i = 0; i < 24; ++i)
    {
      for (int j = i + 2; j < 24 - (i == 0 ? 1 : 0); ++j)
      {
        const auto side = [](const Vector2 & a, const Vector2 & b, const Vector2 & c) {
          return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
        };
        const Vector2 &a = loop[i], &b = loop[i + 1], &c = loop[j], &d = loop[(j + 1) % 24];
        crosses = crosses || (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0);
      }
    }
    bad += crosses;
    if (crosses)
    {
      EXPECT_THROW(MakeStack({ loop }, 1)->Verify(), itk::ExceptionObject) << "trial " << trial;
    }
    else
    {
      EXPECT_NO_THROW(MakeStack({ loop }, 1)->Verify()) << "trial " << trial;
    }
  }
  EXPECT_GT(bad, 20);
}

TEST(ContourStack, AreaAndInsideOfPolygons)
{
  const auto circle = Circle(3, 1000, { 1e4, -1e4 });
  EXPECT_NEAR(SignedArea(circle), M_PI * 9, 1e-3);
  EXPECT_NEAR(SignedArea({ circle.rbegin(), circle.rend() }), -M_PI * 9, 1e-3);
  EXPECT_TRUE(PointInPolygon({ 1e4 + 2.9, -1e4 }, circle));
  EXPECT_FALSE(PointInPolygon({ 1e4 + 3.1, -1e4 }, circle));
  EXPECT_EQ(SignedArea({}), 0.0);
  EXPECT_FALSE(PointInPolygon({ 0, 0 }, {}));
}

TEST(ContourStack, GraftCopiesAndRefusesOtherTypes)
{
  const auto stack = MakeStack({ Circle(5, 20) });
  stack->SetOpenEnd(true);
  auto copy = ContourStack::New();
  copy->Graft(stack);
  EXPECT_EQ(copy->GetSlices().size(), 3u);
  EXPECT_TRUE(copy->GetOpenEnd());
  EXPECT_EQ(copy->GetU(), stack->GetU());
  EXPECT_THROW(copy->Graft(itk::DataObject::New()), itk::ExceptionObject);
  copy->Initialize();
  EXPECT_TRUE(copy->GetSlices().empty());
}
} // namespace ContourStackTests
} // namespace bone
