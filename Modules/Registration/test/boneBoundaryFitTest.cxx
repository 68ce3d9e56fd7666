/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBoundaryFit.h"

#include "boneVolumeTestBody.h"

#include <gtest/gtest.h>

#include <functional>

namespace BoundaryFitTests
{
using namespace bone;

/** Values that depend on x alone, on oblique voxels of 1 x 0.8 x 1.2 mm; x is a physical coordinate. */
VoxelVolume
Along(const std::function<double(double)> & value)
{
  VoxelVolume volume;
  volume.grid.size = { { 60, 50, 40 } };
  volume.grid.axes = Eigen::AngleAxisd(0.3, Vector3(1, 2, 3).normalized()).toRotationMatrix() *
                     Eigen::Matrix3d(Vector3(1.0, 0.8, 1.2).asDiagonal());
  volume.grid.origin = -volume.grid.axes * Vector3(30, 25, 20);
  for (int k = 0; k < 40; ++k)
  {
    for (int j = 0; j < 50; ++j)
    {
      for (int i = 0; i < 60; ++i)
      {
        volume.values.push_back(static_cast<float>(value(volume.grid.Centre(i, j, k)[0])));
      }
    }
  }
  return volume;
}

/** A ramp over a millimetre and a half about `edge`, from `high` to `low`. */
double
Step(double x, double edge, double high, double low)
{
  return low + (high - low) * std::clamp(0.5 - (x - edge) / 1.5, 0.0, 1.0);
}

TEST(BoundaryFit, AnEdgeIsWhereTheDensityIsHalfWay)
{
  for (const double edge : { -3.0, -0.4, 0.0, 2.6 })
  {
    const VoxelVolume    ct = Along([edge](double x) { return Step(x, edge, 900.0, 40.0); });
    const BoundaryTarget target = FindBoundary(ct.View(), Vector3(0, 0.3, -0.7), Vector3::UnitX(), 5.0, 150.0);
    EXPECT_TRUE(target.visible);
    EXPECT_EQ(target.weight, 1.0);
    EXPECT_NEAR(target.offset, edge, 0.15) << edge;
  }
}

TEST(BoundaryFit, EdgesOutOfRangeOrTheOtherWayOrBelowBoneDoNotCount)
{
  const auto weight = [](const std::function<double(double)> & value, double range) {
    return FindBoundary(Along(value).View(), Vector3::Zero(), Vector3::UnitX(), range, 150.0).weight;
  };
  const auto fall = [](double x) { return Step(x, 4.0, 900.0, 40.0); };
  EXPECT_EQ(weight(fall, 5.0), 1.0);
  EXPECT_EQ(weight(fall, 3.0), 0.0);
  EXPECT_EQ(weight([&](double x) { return fall(-x); }, 5.0), 0.0);
  EXPECT_EQ(weight([](double x) { return Step(x, 1.0, 140.0, -100.0); }, 5.0), 0.0);
  EXPECT_EQ(weight([](double) { return 900.0; }, 5.0), 0.0);
  const double faint = weight([](double x) { return Step(x, 1.0, 250.0, 40.0); }, 5.0);
  EXPECT_GT(faint, 0.3);
  EXPECT_LT(faint, 0.9);
}

TEST(BoundaryFit, TheBoneEndsBeforeItsNeighbour)
{
  // A gap from 1 to 4 mm, and the neighbour's far side at 4.8 mm is nearer to where the point is.
  const VoxelVolume ct =
    Along([](double x) { return std::max(Step(x, 1.0, 900.0, 40.0), 40.0 + Step(-x, -2.5, 900.0, 0.0) * (x < 4.8)); });
  EXPECT_NEAR(FindBoundary(ct.View(), Vector3(3.6, 0, 0), Vector3::UnitX(), 6.0, 150.0).offset, -2.6, 0.4);
}

TEST(BoundaryFit, WhatTheCTDoesNotShowIsNotVisible)
{
  const VoxelVolume ct = Along([](double x) { return Step(x, 1.0, 900.0, 40.0); });
  EXPECT_FALSE(FindBoundary(ct.View(), Vector3(100, 0, 0), Vector3::UnitX(), 5.0, 150.0).visible);
}

TEST(BoundaryFit, StepsBringTheMeanOntoABodyOfTheAtlas)
{
  const StatisticalModelContent  atlas = test::BarAtlas();
  DeformableRadiographParameters parameters;
  parameters.smoothModes = 0;
  const DeformableModel model(atlas, parameters);
  Eigen::VectorXd       truth = Eigen::VectorXd::Zero(model.GetNumberOfCoefficients());
  truth.head<2>() << 1.0, -0.8;
  RigidPose pose;
  pose.centre = Vector3(5, 0, 40);
  MeshArrays body = atlas.mean;
  body.points = model.MovePoints(truth);
  const VoxelVolume           ct = test::Scan(body, pose);
  const VolumeView            view = ct.View();
  BoundaryFit                 fit(model, view, 150.0);
  Eigen::Matrix<double, 6, 1> off;
  off << 2.0, -1.5, 1.0, 0.05, -0.04, 0.06;
  VolumeState state{ pose.Moved(off), Eigen::VectorXd::Zero(2) };
  EXPECT_LT(fit.Judge(fit.Points(state), Execution()).supported, 0.7);
  for (int i = 0; i < 12; ++i)
  {
    fit.Step(state, 6.0, 2, Execution());
  }
  EXPECT_NEAR(state.coefficients[0], 1.0, 0.15);
  EXPECT_NEAR(state.coefficients[1], -0.8, 0.2);
  EXPECT_LT(state.pose.StepTo(pose).head<3>().norm(), 0.3);
  const BoundarySupport support = fit.Judge(fit.Points(state), Execution());
  EXPECT_EQ(support.visible, 1.0);
  EXPECT_GT(support.supported, 0.97);
  EXPECT_LT(support.residual, 0.25);
}

TEST(BoundaryFit, WithoutEdgesThePriorAloneCounts)
{
  const StatisticalModelContent  atlas = test::BarAtlas();
  DeformableRadiographParameters parameters;
  parameters.smoothModes = 0;
  const DeformableModel model(atlas, parameters);
  const VoxelVolume     ct = Along([](double) { return 40.0; });
  const VolumeView      view = ct.View();
  BoundaryFit           fit(model, view, 150.0);
  VolumeState           state{ RigidPose(), Eigen::Vector2d(1.5, -1.0) };
  fit.Step(state, 5.0, 1, Execution());
  EXPECT_NEAR(state.coefficients[0], 0.0, 1e-9);
  EXPECT_EQ(state.coefficients[1], -1.0); // not among the modes of the step
  EXPECT_NEAR(state.pose.translation.norm(), 0.0, 1e-9);
}

TEST(BoundaryFit, PartsWithoutAnEdgeAreNamed)
{
  const StatisticalModelContent  atlas = test::BarAtlas();
  DeformableRadiographParameters parameters;
  parameters.smoothModes = 0;
  const DeformableModel model(atlas, parameters);
  VoxelVolume           ct = test::Scan(atlas.mean, RigidPose());
  // Nothing above z = 60 but dense bone: no edge there.
  for (std::size_t i = 0; i < ct.values.size(); ++i)
  {
    const auto slice = static_cast<std::size_t>(ct.grid.size[0]) * ct.grid.size[1];
    if (ct.grid.Centre(0, 0, static_cast<int>(i / slice))[2] > 60.0)
    {
      ct.values[i] = 900.0F;
    }
  }
  const VolumeView              view = ct.View();
  BoundaryFit                   fit(model, view, 150.0);
  std::vector<UnsupportedPatch> patches;
  const VolumeState             state{ RigidPose(), Eigen::VectorXd::Zero(2) };
  const auto                    support = fit.Judge(fit.Points(state), Execution(), &patches);
  EXPECT_LT(support.supported, 0.85);
  ASSERT_FALSE(patches.empty());
  EXPECT_GT(patches.front().centre[2], 60.0);
  EXPECT_NEAR(patches.front().share, 1.0 - support.supported, 0.05);
}
} // namespace BoundaryFitTests
