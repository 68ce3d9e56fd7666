/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneShownPoints.h"

#include "boneRegistrationTestBody.h"

#include <gtest/gtest.h>

namespace ShownPointsTests
{
using namespace bone;
using namespace bone::test;
using Which = std::vector<std::size_t>;

const RigidPose Upright = PoseOf(0, 0, 0, 0, 0, 0);

/** Of points on the z axis through the views' centre, which show 95 pixels of 1.6 * 0.7 mm there: 53.2 mm up and down.
 */
Which
Shown(const std::vector<double> & heights,
      double                      beyond,
      const RigidPose &           pose = Upright,
      double                      raised = 0.0,
      bool                        single = false)
{
  std::vector<RadiographView> views(2);
  views[0].view = ViewOf({ 0, 1, 0 });
  views[1].view = ViewOf({ 1, 0, 0 });
  // The second view's detector further up.
  views[1].view.detectorOrigin.z() += raised;
  views.resize(single ? 1 : 2);
  std::vector<Vector3> points;
  for (const double height : heights)
  {
    points.push_back(Upright.centre + height * Vector3::UnitZ());
  }
  return ShownPoints(points, pose, views, beyond);
}

TEST(ShownPoints, AreThoseThatEachViewShows)
{
  EXPECT_EQ(Shown({ -54, -53, 0, 53, 54 }, 0.0), (Which{ 1, 2, 3 }));
  EXPECT_EQ(Shown({ -54, -53, 0, 53, 54 }, 0.0, Upright, 10.0), (Which{ 2, 3 }));
}

TEST(ShownPoints, AreTakenInTheirPlace)
{
  EXPECT_EQ(Shown({ -54, -53, 0, 53, 54 }, 0.0, PoseOf(0, 0, 10, 0, 0, 0)), (Which{ 0, 1, 2 }));
  // Half as far from the first source, the view shows half as much.
  EXPECT_EQ(Shown({ -30, -26, 0, 26, 30 }, 0.0, PoseOf(0, -350, 0, 0, 0, 0), 0.0, true), (Which{ 1, 2, 3 }));
}

TEST(ShownPoints, ThoseThatAMoveWouldShowCountToo)
{
  EXPECT_EQ(Shown({ -64, -62, 0, 62, 64 }, 10.0), (Which{ 1, 2, 3 })) << "10 mm at the bone, not at the detector";
}

TEST(ShownPoints, AreAllWhereNoneShows)
{
  EXPECT_EQ(Shown({ 80, 90, 100 }, 0.0), (Which{ 0, 1, 2 }));
  EXPECT_EQ(Shown({ 0, 10 }, 0.0, PoseOf(0, -900, 0, 0, 0, 0), 0.0, true), (Which{ 0, 1 })) << "behind the source";
}

TEST(ShownPoints, MeanIsOfThoseAlone)
{
  EXPECT_EQ(MeanOf({ Vector3(1, 2, 3), Vector3(9, 9, 9), Vector3(3, 4, 5) }, { 0, 2 }), Vector3(2, 3, 4));
}
} // namespace ShownPointsTests
