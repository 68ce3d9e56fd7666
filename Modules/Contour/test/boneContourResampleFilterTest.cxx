/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourResampleFilter.h"

#include "boneClosedBSpline.h"
#include "boneContourSampling.h"
#include "boneContourTestTools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace bone
{
namespace ContourResampleFilterTests
{
using testing::HasSubstr;

ContourResampleFilter::Pointer
Resampler(ContourStack * stack, double maximumSpacing)
{
  auto filter = ContourResampleFilter::New();
  filter->SetInput(stack);
  filter->SetMaximumSpacing(maximumSpacing);
  return filter;
}

// Least distance between two contours of the first slice.
double
LeastDistance(const ContourStack & stack, std::size_t a, std::size_t b)
{
  const auto & contours = stack.GetSlices()[0].contours;
  double       distance = std::numeric_limits<double>::max();
  for (const auto & [from, to] : { std::pair{ a, b }, std::pair{ b, a } })
  {
    const Polygon polygon = PlanePoints(stack, contours[to]);
    for (const Vector2 & q : PlanePoints(stack, contours[from]))
    {
      distance = std::min(distance, DistanceTo(q, polygon));
    }
  }
  return distance;
}

TEST(ClosedBSpline, FitsACircleAndAnEllipseWithinTolerance)
{
  for (const double b : { 20.0, 6.0 })
  {
    for (const double tolerance : { 0.2, 0.01 })
    {
      const Polygon    given = Ellipse(20.0, b, 300);
      const BSplineFit fit = FitClosedBSplineWithin(given, tolerance);
      EXPECT_LE(fit.deviation, tolerance);
      EXPECT_LT(fit.curve.GetNumberOfControlPoints(), 60u);
      for (double t = 0.0; t < 6.0; t += 0.1)
      {
        const double  at = t / 6.0 * static_cast<double>(fit.curve.GetNumberOfControlPoints());
        const Vector2 q = fit.curve.Evaluate(at);
        EXPECT_LE(DistanceTo(q, Ellipse(20.0, b, 3000)), tolerance + 1e-4);
      }
    }
  }
}

TEST(ClosedBSpline, DerivativesAndCurvatureOfACircle)
{
  const BSplineFit fit = FitClosedBSpline(Ellipse(10, 10, 400), 24);
  for (double t = 0.0; t < 24.0; t += 0.37)
  {
    EXPECT_NEAR(fit.curve.Curvature(t), 0.1, 2e-3);
    const Vector2 slope = (fit.curve.Evaluate(t + 1e-6) - fit.curve.Evaluate(t - 1e-6)) / 2e-6;
    EXPECT_NEAR((slope - fit.curve.Evaluate(t, 1)).norm(), 0.0, 1e-6);
  }
  EXPECT_NEAR((fit.curve.Evaluate(-0.5) - fit.curve.Evaluate(23.5)).norm(), 0.0, 1e-12);
}

TEST(ClosedBSpline, SmoothsNoise)
{
  std::mt19937               random(2);
  std::normal_distribution<> normal(0.0, 0.1);
  Polygon                    given = Ellipse(15, 9, 300);
  for (Vector2 & q : given)
  {
    q += Vector2(normal(random), normal(random));
  }
  const BSplineFit fit = FitClosedBSpline(given, 16);
  double           worst = 0.0;
  for (double t = 0.0; t < 16.0; t += 0.1)
  {
    worst = std::max(worst, DistanceTo(fit.curve.Evaluate(t), Ellipse(15, 9, 2000)));
  }
  EXPECT_LT(worst, 0.1);
}

TEST(ContourResampleFilter, SpacingFollowsCurvatureBetweenItsLimits)
{
  auto filter = Resampler(OneSlice({ Ellipse(30, 8, 600) }, { 0 }), 4.0);
  filter->SetTolerance(0.05);
  filter->Update();
  const auto &  contour = filter->GetOutput()->GetSlices()[0].contours.at(0);
  const Polygon sampled = PlanePoints(*filter->GetOutput(), contour);
  double        atTip = 1e9;
  double        atSide = 0.0;
  for (std::size_t i = 0; i < sampled.size(); ++i)
  {
    const Vector2 middle = 0.5 * (sampled[i] + sampled[(i + 1) % sampled.size()]);
    const double  d = (sampled[i] - sampled[(i + 1) % sampled.size()]).norm();
    EXPECT_LE(d, 4.0 + 1e-9);
    EXPECT_GE(d, 0.75);
    if (std::abs(middle.x()) > 28.0)
    {
      atTip = std::min(atTip, d);
    }
    if (std::abs(middle.x()) < 5.0)
    {
      atSide = std::max(atSide, d);
    }
  }
  // sqrt(12 * 0.05 / curvature): 1.13 mm at the tip (curvature 30/64), the limit of 4 mm at the side (8/900).
  EXPECT_NEAR(atTip, 1.13, 0.2);
  EXPECT_NEAR(atSide, 4.0, 0.5);
}

TEST(ContourResampleFilter, DensityIsTheSquareRootOfCurvature)
{
  auto filter = Resampler(OneSlice({ Ellipse(20, 12, 800) }, { 0 }), 50.0);
  filter->SetMinimumSpacing(0.05);
  filter->SetTolerance(0.01);
  filter->Update();
  const Polygon sampled = PlanePoints(*filter->GetOutput(), filter->GetOutput()->GetSlices()[0].contours[0]);
  for (std::size_t i = 0; i < sampled.size(); ++i)
  {
    const Vector2 next = sampled[(i + 1) % sampled.size()];
    const Vector2 middle = 0.5 * (sampled[i] + next);
    // Curvature of the ellipse at the middle's parameter.
    const double t = std::atan2(middle.y() / 12.0, middle.x() / 20.0);
    const double speed = std::hypot(20.0 * std::sin(t), 12.0 * std::cos(t));
    const double curvature = 20.0 * 12.0 / (speed * speed * speed);
    EXPECT_NEAR((next - sampled[i]).norm() / std::sqrt(0.12 / curvature), 1.0, 0.1);
  }
}

TEST(ContourResampleFilter, CoarseSamplesKeepTheArea)
{
  for (const double tolerance : { 0.1, 0.3, 0.9 })
  {
    auto filter = Resampler(OneSlice({ Ellipse(20, 12, 800) }, { 0 }), 50.0);
    filter->SetTolerance(tolerance);
    filter->Update();
    const Polygon sampled = PlanePoints(*filter->GetOutput(), filter->GetOutput()->GetSlices()[0].contours[0]);
    EXPECT_LT(sampled.size(), 60U);
    EXPECT_NEAR(bone::SignedArea(sampled) / (M_PI * 20.0 * 12.0), 1.0, 0.003);
    for (const Vector2 & q : sampled)
    {
      // A corner lies outside by two thirds of what the chord rises, at most.
      const double r = std::hypot(q.x() / 20.0, q.y() / 12.0);
      EXPECT_GT(r, 1.0);
      EXPECT_LT((r - 1.0) * 12.0, 1.5 * tolerance);
    }
  }
}

TEST(ContourResampleFilter, TargetsAreMet)
{
  auto stack = OneSlice({ Ellipse(25, 14, 400), Ellipse(21, 10, 400) }, { 0, 1 });
  auto slices = stack->GetSlices();
  for (int k = 1; k < 6; ++k)
  {
    slices.push_back(slices[0]);
    slices.back().origin.z() = k;
    for (Contour & contour : slices.back().contours)
    {
      for (Vector3 & p : contour.points)
      {
        p = Vector3(p.x(), p.y() * (1.0 - 0.02 * k), k);
      }
    }
  }
  stack->SetSlices(slices);
  auto filter = Resampler(stack, 4.0);
  for (const std::size_t target : { 240u, 500u, 1500u })
  {
    filter->SetTargetNumberOfSamples(target);
    filter->Update();
    EXPECT_NEAR(static_cast<double>(CountSamples(*filter->GetOutput())) / static_cast<double>(target), 1.0, 0.02);
    EXPECT_EQ(filter->GetReport().samples, static_cast<int>(CountSamples(*filter->GetOutput())));
  }
  filter->SetTargetNumberOfTetrahedra(4000);
  EXPECT_THAT(MessageOf([&] { filter->Update(); }), HasSubstr("TargetNumberOfTetrahedra"));
  filter->SetTargetNumberOfSamples(0);
  filter->Update();
  EXPECT_NEAR(EstimateTetrahedra(*filter->GetOutput()) / 4000.0, 1.0, 0.02);
  EXPECT_TRUE(filter->GetWarnings().empty());
  // Eight points a contour is the least there is.
  filter->SetTargetNumberOfTetrahedra(100);
  filter->Update();
  EXPECT_THAT(filter->GetWarnings().at(0), HasSubstr("nearest to 100 tetrahedra"));
}

TEST(ContourResampleFilter, NestedContoursKeepTheirDistanceAtAnySpacing)
{
  Polygon hole = Ellipse(2, 2, 80, { 11.8, 0 });
  std::reverse(hole.begin(), hole.end());
  for (const double spacing : { 1.0, 3.0, 6.0 })
  {
    auto filter = Resampler(
      OneSlice({ Ellipse(20, 14, 400), Ellipse(19.2, 13.2, 400, { 0, 0 }), Ellipse(9, 9, 200), hole }, { 0, 1, 2, 1 }),
      spacing);
    filter->SetMinimumSpacing(0.5 * spacing);
    filter->Update();
    const ContourStack & output = *filter->GetOutput();
    EXPECT_GE(LeastDistance(output, 0, 1), 0.8);
    EXPECT_GE(LeastDistance(output, 1, 2), 0.8);
    EXPECT_GE(LeastDistance(output, 2, 3), 0.8 * (1.0 - 1e-9));
  }
}

TEST(ContourResampleFilter, ReportsSamplesMovedToKeepTheDistance)
{
  const auto run = [](double inner) {
    auto filter = Resampler(OneSlice({ Ellipse(20, 20, 400), Ellipse(inner, inner, 400) }, { 0, 1 }), 4.0);
    filter->SetMinimumLayerDistance(1.0);
    filter->Update();
    return filter;
  };
  EXPECT_EQ(run(17.0)->GetReport().moved, 0);
  const auto tight = run(19.5); // all of the inner contour is too near
  EXPECT_GE(LeastDistance(*tight->GetOutput(), 0, 1), 1.0 - 1e-9);
  EXPECT_GE(tight->GetReport().moved, static_cast<int>(tight->GetOutput()->GetSlices()[0].contours[1].points.size()));
}

TEST(ContourResampleFilter, InnerContoursOfOneLayerKeepTheirDistanceFromEachOther)
{
  // Two halves of a trabecular layer, 0.9 mm apart, wavy where they face each other.
  const auto half = [](double side) {
    Polygon loop;
    for (int i = 0; i <= 200; ++i)
    {
      const double y = -8.0 + 0.08 * i;
      loop.push_back(Vector2(side * 0.45 + 0.5 * std::sin(y), y));
    }
    loop.push_back(Vector2(side * 9.0, 8.0));
    loop.push_back(Vector2(side * 9.0, -8.0));
    if (side > 0)
    {
      std::reverse(loop.begin(), loop.end());
    }
    return loop;
  };
  for (const double spacing : { 1.0, 3.0, 6.0 })
  {
    auto filter = Resampler(OneSlice({ Ellipse(20, 14, 400), half(-1.0), half(1.0) }, { 0, 1, 1 }), spacing);
    filter->SetMinimumSpacing(0.5 * spacing);
    filter->SetMinimumLayerDistance(0.7);
    filter->Update();
    EXPECT_GE(LeastDistance(*filter->GetOutput(), 1, 2), 0.7 * (1.0 - 1e-9)) << spacing;
  }
}

TEST(ContourResampleFilter, SamplesLieOnTheSplineAndKeepOrder)
{
  const Polygon outer = Ellipse(20, 14, 400);
  const Polygon inner = Ellipse(18, 12, 400);
  auto          filter = Resampler(OneSlice({ outer, inner }, { 0, 1 }), 4.0);
  filter->SetTolerance(0.02);
  filter->Update();
  const auto & contours = filter->GetOutput()->GetSlices()[0].contours;
  ASSERT_EQ(contours.size(), 2u);
  EXPECT_EQ(contours[1].layer, 1);
  EXPECT_EQ(contours[1].region, 2);
  for (const Vector2 & q : PlanePoints(*filter->GetOutput(), contours[0]))
  {
    EXPECT_LT(DistanceTo(q, outer), 0.025);
  }
  EXPECT_GT(SignedArea(PlanePoints(*filter->GetOutput(), contours[1])), 0.0);
}

TEST(ContourResampleFilter, ThinLayersAreSampledFiner)
{
  // Thickness 1 mm on the left, 6 mm on the right.
  auto filter = Resampler(OneSlice({ Ellipse(20, 20, 500), Ellipse(16.5, 16.5, 500, { -2.5, 0 }) }, { 0, 1 }), 5.0);
  filter->SetThinLayerRatio(2.0);
  filter->Update();
  const Polygon sampled = PlanePoints(*filter->GetOutput(), filter->GetOutput()->GetSlices()[0].contours[0]);
  for (std::size_t i = 0; i < sampled.size(); ++i)
  {
    const double d = (sampled[i] - sampled[(i + 1) % sampled.size()]).norm();
    if (sampled[i].x() < -19.0)
    {
      EXPECT_LT(d, 2.6);
    }
    if (sampled[i].x() > 19.0)
    {
      EXPECT_GT(d, 3.5);
    }
  }
}

TEST(ContourResampleFilter, NestedContoursStayApartAtACoarseSpacing)
{
  // A wavy layer 0.8 mm thick, sampled far more coarsely than its waves.
  const auto wavy = [](double radius) {
    Polygon loop;
    for (int i = 0; i < 720; ++i)
    {
      const double t = 2.0 * M_PI * i / 720;
      loop.push_back((radius + 1.5 * std::cos(9 * t)) * Vector2(std::cos(t), std::sin(t)));
    }
    return loop;
  };
  auto filter = Resampler(OneSlice({ wavy(20.0), wavy(18.9) }, { 0, 1 }), 12.0);
  filter->SetMinimumSpacing(6.0);
  filter->SetTolerance(1.0);
  ASSERT_NO_THROW(filter->Update());
  const ContourStack * output = filter->GetOutput();
  EXPECT_NO_THROW(output->Verify());
  EXPECT_GT(filter->GetReport().refined, 0);
  const Polygon outer = PlanePoints(*output, output->GetSlices()[0].contours[0]);
  for (const Vector2 & q : PlanePoints(*output, output->GetSlices()[0].contours[1]))
  {
    EXPECT_TRUE(PointInPolygon(q, outer));
    EXPECT_GT(DistanceTo(q, outer), 0.35);
  }
}

TEST(ContourResampleFilter, IsLazyAndTheSameForAnyNumberOfThreads)
{
  auto stack = OneSlice({ Ellipse(20, 14, 400), Ellipse(17, 11, 400) }, { 0, 1 });
  auto slices = stack->GetSlices();
  for (int k = 1; k < 9; ++k)
  {
    slices.push_back(slices[0]);
    slices.back().origin.z() = k;
    for (Contour & contour : slices.back().contours)
    {
      for (Vector3 & p : contour.points)
      {
        p = Vector3(p.x() * (1.0 + 0.01 * k), p.y(), k);
      }
    }
  }
  stack->SetSlices(slices);
  auto one = Resampler(stack, 3.0);
  one->SetNumberOfWorkUnits(1);
  one->Update();
  const auto time = one->GetOutput()->GetMTime();
  one->Update();
  EXPECT_EQ(one->GetOutput()->GetMTime(), time);
  auto four = Resampler(stack, 3.0);
  four->SetNumberOfWorkUnits(4);
  four->Update();
  for (std::size_t k = 0; k < slices.size(); ++k)
  {
    for (std::size_t c = 0; c < 2; ++c)
    {
      EXPECT_EQ(one->GetOutput()->GetSlices()[k].contours[c].points,
                four->GetOutput()->GetSlices()[k].contours[c].points);
    }
  }
  one->SetTolerance(0.1);
  one->Update();
  EXPECT_NE(one->GetOutput()->GetMTime(), time);
}

TEST(ContourResampleFilter, RefusesBadInput)
{
  auto filter = Resampler(OneSlice({ Ellipse(5, 5, 50) }, { 0 }), 0.5);
  EXPECT_THAT(MessageOf([&] { filter->Update(); }), HasSubstr("MinimumSpacing"));
  filter->SetMaximumSpacing(4.0);
  filter->SetTolerance(std::nan(""));
  EXPECT_THAT(MessageOf([&] { filter->Update(); }), HasSubstr("Tolerance"));
  auto crossing = Resampler(OneSlice({ Ellipse(5, 5, 50), Ellipse(5, 5, 50, { 3, 0 }) }, { 0, 1 }), 4.0);
  EXPECT_THAT(MessageOf([&] { crossing->Update(); }), HasSubstr("crosses"));
  auto empty = Resampler(ContourStack::New(), 4.0);
  EXPECT_THAT(MessageOf([&] { empty->Update(); }), HasSubstr("no contour"));
}
} // namespace ContourResampleFilterTests
} // namespace bone
