/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCorticalProfile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace CorticalProfileTests
{
// 1 well beyond depth 0, 0 well before, blurred by a Gaussian.
double
Blurred(double depth, double blur)
{
  return 0.5 * std::erfc(-depth / (blur * std::sqrt(2.0)));
}

// Soft tissue at 50 HU, cortex of 1300 HU from depth 0 to `thickness`, then `inside` HU, from `marrow` on -50 HU.
CorticalProfile
Profile(double thickness, double blur, double inside = 200.0, double marrow = 1e9)
{
  CorticalProfile profile;
  profile.step = 0.1;
  profile.lead = 25;
  for (int k = -profile.lead; k < 100; ++k)
  {
    const double d = k * profile.step;
    profile.values.push_back(50.0 + 1250.0 * Blurred(d, blur) + (inside - 1300.0) * Blurred(d - thickness, blur) +
                             (-50.0 - inside) * Blurred(d - marrow, blur));
  }
  return profile;
}

TEST(CorticalProfile, AThickCortexEndsHalfWayToTheLevelJustInside)
{
  for (const double marrow : { 1e9, 7.0 })
  {
    const CorticalEdges edges = FindCorticalEdges(Profile(4.0, 0.4, 200.0, marrow), CorticalRules());
    ASSERT_EQ(edges.kind, CorticalEdges::Kind::Found);
    EXPECT_NEAR(edges.outer, 0.0, 0.02);
    EXPECT_NEAR(edges.inner, 4.0, 0.02);
    EXPECT_NEAR(edges.blur, 0.4, 0.02);
  }
}

TEST(CorticalProfile, AThinCortexIsMeasuredThroughItsBlur)
{
  for (const double thickness : { 0.7, 1.0, 1.5, 2.5 })
  {
    const double        blur = 0.45;
    const CorticalEdges edges = FindCorticalEdges(Profile(thickness, blur, 50.0), CorticalRules());
    ASSERT_EQ(edges.kind, CorticalEdges::Kind::Found);
    const double width = edges.inner - edges.outer;
    EXPECT_NEAR(0.5 * (edges.inner + edges.outer), 0.5 * thickness, 0.02);
    EXPECT_GT(width, thickness - 1e-3);
    EXPECT_NEAR(ThicknessOfBlurredLayer(width, blur), thickness, 0.04) << thickness;
  }
}

TEST(CorticalProfile, WhatIsDenserFurtherInThanACortexReachesIsNotTheCortex)
{
  CorticalProfile profile = Profile(1.5, 0.2);
  std::fill(profile.values.begin() + profile.lead + 70, profile.values.end(), 1800.0);
  const CorticalEdges edges = FindCorticalEdges(profile, CorticalRules());
  ASSERT_EQ(edges.kind, CorticalEdges::Kind::Found);
  EXPECT_NEAR(edges.outer, 0.0, 0.02);
  EXPECT_NEAR(edges.inner, 1.5, 0.02);
}

TEST(CorticalProfile, ABlurredLayersThicknessIsItsWidthWithoutBlurAndHasAFloor)
{
  EXPECT_DOUBLE_EQ(ThicknessOfBlurredLayer(1.3, 0.0), 1.3);
  EXPECT_DOUBLE_EQ(ThicknessOfBlurredLayer(3.0, 0.5), 3.0);
  EXPECT_NEAR(ThicknessOfBlurredLayer(1.0, 0.5), 0.5, 1e-6); // narrower than any layer can be
  double before = 0.0;
  for (double width = 1.2; width < 2.6; width += 0.1)
  {
    const double thickness = ThicknessOfBlurredLayer(width, 0.5);
    EXPECT_GT(thickness, before);
    before = thickness;
  }
}

TEST(CorticalProfile, SaysWhereThereIsNoEnd)
{
  EXPECT_EQ(FindCorticalEdges(Profile(20.0, 0.4), CorticalRules()).kind, CorticalEdges::Kind::Solid);
  CorticalProfile flat = Profile(4.0, 0.4);
  std::fill(flat.values.begin(), flat.values.end(), 180.0);
  EXPECT_EQ(FindCorticalEdges(flat, CorticalRules()).kind, CorticalEdges::Kind::None);
  flat.values.resize(26);
  EXPECT_EQ(FindCorticalEdges(flat, CorticalRules()).kind, CorticalEdges::Kind::None);
  CorticalRules rules;
  rules.endostealThreshold = 600.0;
  const CorticalEdges edges = FindCorticalEdges(Profile(4.0, 0.4, 50.0), rules);
  EXPECT_NEAR(edges.inner, 4.0, 0.1);
}
} // namespace CorticalProfileTests
} // namespace bone
