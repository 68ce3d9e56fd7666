/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVolumeSearch.h"

#include "boneVolumeTestBody.h"

#include <gtest/gtest.h>

namespace VolumeSearchTests
{
using namespace bone;

/** Mean distance of the mean's points under a candidate's pose from where they are. */
double
DistanceOf(const VolumeCandidate & candidate, const RigidPose & truth, const std::vector<Vector3> & points)
{
  double sum = 0.0;
  for (const Vector3 & x : points)
  {
    sum += (candidate.pose.Apply(x) - truth.Apply(x)).norm();
  }
  return sum / static_cast<double>(points.size());
}

TEST(VolumeSearch, FewHypothesesFindTheMeanFromAnySide)
{
  const StatisticalModelContent  atlas = test::BarAtlas();
  DeformableRadiographParameters ofModel;
  ofModel.smoothModes = 0;
  const DeformableModel model(atlas, ofModel);
  AtlasVolumeParameters parameters;
  parameters.hypotheses = 2000;
  for (int i = 0; i < 4; ++i)
  {
    RigidPose pose = test::SomePose();
    pose.rotation = Eigen::AngleAxisd(1.5 * i, Vector3(0, 0, 1)) * pose.rotation;
    const VoxelVolume ct = test::Scan(atlas.mean, pose);
    const auto        found = SearchVolume(model, ct.View(), parameters, Execution());
    ASSERT_FALSE(found.empty());
    EXPECT_LT(DistanceOf(found.front(), pose, atlas.mean.points), 4.0) << i;
    for (std::size_t k = 1; k < found.size(); ++k)
    {
      EXPECT_LE(found[k].score, found[k - 1].score);
    }
  }
}
} // namespace VolumeSearchTests
