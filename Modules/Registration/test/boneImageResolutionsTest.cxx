/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageResolutions.h"

#include "boneRegistrationTestBody.h"

#include <gtest/gtest.h>

namespace ImageResolutionsTests
{
using namespace bone;
using namespace bone::test;

const RigidPose Upright = PoseOf(0, 0, 0, 0, 0, 0);

/** Of a needle about the views' centre, which takes up so much of the longer sides of two X-rays when it is upright. */
std::vector<int>
Resolutions(int searchPixels, int pixels, double share, const RigidPose & start = Upright)
{
  std::vector<RadiographView> views(2);
  views[0].view = ViewOf({ 0, 1, 0 }, 256);
  views[1].view = ViewOf({ 1, 0, 0 }, 256);
  views[0].view.size[0] = 100;                                  // narrower than it is long
  const Vector3 end(0, 0, 0.5 * share * 96 * 1.6 * 700 / 1000); // at the bone, not at the detector
  return ImageResolutions(searchPixels, pixels, { Upright.centre - end, Upright.centre + end }, start, views);
}

using Sides = std::vector<int>;

TEST(ImageResolutions, DoublesFromTheSearchToTheLast)
{
  EXPECT_EQ(Resolutions(96, 256, 0.61), (Sides{ 96, 192, 256 }));
  EXPECT_EQ(Resolutions(128, 256, 0.61), (Sides{ 128, 256 }));
  EXPECT_EQ(Resolutions(300, 256, 0.61), (Sides{ 256 }));
  EXPECT_EQ(Resolutions(96, 256, 1.5), (Sides{ 96, 192, 256 })) << "a bone that is partly in view";
}

TEST(ImageResolutions, BeginsFinerWhereTheBoneTakesUpLittle)
{
  EXPECT_EQ(Resolutions(96, 256, 0.4), (Sides{ 144, 256 }));
  EXPECT_EQ(Resolutions(96, 256, 0.3), (Sides{ 192, 256 }));
  EXPECT_EQ(Resolutions(96, 1024, 0.3), (Sides{ 192, 384, 768, 1024 }));
  EXPECT_EQ(Resolutions(96, 256, 1e-9), (Sides{ 256 }));
}

TEST(ImageResolutions, CountsTheViewThatShowsLeastOfTheBoneAsItStands)
{
  const double quarter = 0.5 * std::acos(-1.0);
  EXPECT_EQ(Resolutions(96, 256, 0.61, PoseOf(0, 0, 0, quarter, 0, 0)), (Sides{ 256 })) << "along the first beam";
  EXPECT_EQ(Resolutions(96, 256, 0.61, PoseOf(0, 0, 0, 0, quarter, 0)), (Sides{ 256 })) << "along the second";
  // Twice as near to the source of the first view, beside the second one's middle.
  EXPECT_EQ(Resolutions(96, 256, 0.4, PoseOf(0, -350, 0, 0, 0, 0)), (Sides{ 144, 256 }));
  EXPECT_EQ(Resolutions(96, 256, 0.4, PoseOf(-175, -175, 0, 0, 0, 0)), (Sides{ 108, 216, 256 }));
}
} // namespace ImageResolutionsTests
