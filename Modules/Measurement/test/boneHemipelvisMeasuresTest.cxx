/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHemipelvisMeasures.h"

#include "boneHemipelvisPhantom.h"
#include "boneTestFemur.h"
#include "boneTestMeasures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace HemipelvisMeasuresTests
{
using namespace bone;

/** The phantom's surface around the acetabulum, cut off beyond. */
TriangleSurface
PhantomSurface(const HemipelvisPhantom & phantom, double step)
{
  return test::MarchSurface(
    [&phantom](const Vector3 & x) {
      return std::max(phantom.EvaluateLevels(x)[PhantomModel::Periosteal], x.norm() - 60.0);
    },
    Vector3::Constant(-62.1),
    Vector3::Constant(62.3),
    step);
}

/** Seeds, and an anterior pelvic plane across y. */
std::vector<Landmark>
PhantomLandmarks()
{
  return { { "acetabulum", Vector3(3, -2, 2) },
           { "asis", Vector3(-12, -40, 35) },
           { "pubic_tubercle", Vector3(40, -40, -15) } };
}

TEST(HemipelvisMeasures, ThePhantomsAcetabulumIsFound)
{
  // Where ramus or wing rise above the rim's plane they turn it, of one phantom by 1.5 degrees.
  double inclination = 0.0, anteversion = 0.0;
  for (std::uint64_t seed = 0; seed < 10; ++seed)
  {
    const HemipelvisPhantom      phantom(seed);
    const HemipelvisParameters & p = phantom.GetParameters();
    const auto                   hemipelvis = FitHemipelvis(PhantomSurface(phantom, 3.1), PhantomLandmarks());
    const auto                   list = MeasureHemipelvis(hemipelvis);
    EXPECT_TRUE(list.missing.empty());
    EXPECT_NEAR(ValueOf(list, "acetabularRadius"), p.cupRadius, 0.2);
    EXPECT_NEAR(hemipelvis.acetabulum->centre.norm(), 0.0, 0.2);
    EXPECT_NEAR(ValueOf(list, "radiographicInclination"), 90.0 - p.inclination, 2.0);
    EXPECT_NEAR(ValueOf(list, "radiographicAnteversion"), p.cupAnteversion, 1.0);
    inclination += 0.1 * std::abs(ValueOf(list, "radiographicInclination") - 90.0 + p.inclination);
    anteversion += 0.1 * std::abs(ValueOf(list, "radiographicAnteversion") - p.cupAnteversion);
    EXPECT_EQ(SideOf(list), "right");
    // Murray's relations between the definitions.
    const double degree = M_PI / 180.0;
    const double ri = ValueOf(list, "radiographicInclination") * degree,
                 ra = ValueOf(list, "radiographicAnteversion") * degree;
    EXPECT_NEAR(std::tan(ValueOf(list, "anatomicAnteversion") * degree), std::tan(ra) / std::sin(ri), 1e-9);
    EXPECT_NEAR(std::cos(ValueOf(list, "anatomicInclination") * degree), std::cos(ri) * std::cos(ra), 1e-9);
  }
  EXPECT_LT(inclination, 0.7);
  EXPECT_LT(anteversion, 0.5);
}

TEST(HemipelvisMeasures, MoveWithTheBoneWhereLandmarksGiveTheTransverseAxis)
{
  TriangleSurface surface = PhantomSurface(HemipelvisPhantom(), 3.1);
  auto            landmarks = PhantomLandmarks();
  landmarks.push_back({ "asis_right", Vector3(-12, -40, 35) });
  landmarks.push_back({ "asis_left", Vector3(230, -40, 35) });
  const auto still = MeasureHemipelvis(FitHemipelvis(surface, landmarks));
  const auto turn = Eigen::AngleAxisd(2.0, Vector3(-1, 2, 0.3).normalized());
  for (Vector3 & p : surface.points)
  {
    p = turn * p + Vector3(10, 20, 30);
  }
  for (Landmark & landmark : landmarks)
  {
    landmark.point = turn * landmark.point + Vector3(10, 20, 30);
  }
  const auto moved = MeasureHemipelvis(FitHemipelvis(surface, landmarks));
  for (const char * name :
       { "acetabularRadius", "radiographicInclination", "radiographicAnteversion", "anatomicAnteversion" })
  {
    EXPECT_NEAR(ValueOf(moved, name), ValueOf(still, name), 0.5) << name;
  }
  EXPECT_EQ(SideOf(moved), "right");
  EXPECT_THAT(moved.measures[2].definition, testing::HasSubstr("asis_right"));
}

TEST(HemipelvisMeasures, AMirroredBoneIsALeftOneWithTheSameAngles)
{
  TriangleSurface surface = PhantomSurface(HemipelvisPhantom(), 3.1);
  auto            landmarks = PhantomLandmarks();
  const auto      right = MeasureHemipelvis(FitHemipelvis(surface, landmarks));
  for (Vector3 & p : surface.points)
  {
    p.x() = -p.x();
  }
  for (auto & t : surface.triangles)
  {
    std::swap(t[0], t[1]);
  }
  for (Landmark & landmark : landmarks)
  {
    landmark.point.x() = -landmark.point.x();
  }
  const auto left = MeasureHemipelvis(FitHemipelvis(surface, landmarks));
  EXPECT_EQ(SideOf(left), "left");
  EXPECT_NEAR(ValueOf(left, "radiographicInclination"), ValueOf(right, "radiographicInclination"), 0.5);
  EXPECT_NEAR(ValueOf(left, "radiographicAnteversion"), ValueOf(right, "radiographicAnteversion"), 0.5);
}

TEST(HemipelvisMeasures, WhatIsMissingIsSaid)
{
  const auto surface = PhantomSurface(HemipelvisPhantom(), 3.1);
  auto       landmarks = PhantomLandmarks();
  landmarks.pop_back();
  const auto list = MeasureHemipelvis(FitHemipelvis(surface, landmarks));
  EXPECT_GT(ValueOf(list, "acetabularRadius"), 20.0);
  ASSERT_EQ(list.missing.size(), 5u);
  EXPECT_EQ(list.missing[0].reason, "landmark pubic_tubercle is missing");
  EXPECT_EQ(MeasureHemipelvis(FitHemipelvis(surface, {})).missing.size(), 7u);
  EXPECT_EQ(FitHemipelvis(surface, { { "acetabulum", Vector3(40, 30, 30) } }).rim.has_value(), false);
}
} // namespace HemipelvisMeasuresTests
