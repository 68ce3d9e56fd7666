/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDeformableModel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace bone;

/** Two tetrahedra of 1 and 2 mm^3, of regions 1 and 2, with 1000 and 100 HU and a mode of density for each. Of five
 * subjects the last alone differs in the second tetrahedron, by 5 HU. */
StatisticalModelContent
Atlas()
{
  StatisticalModelContent atlas;
  atlas.mean.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 2, 0 }, { 0, 0, 3 }, { 0, 0, -6 } };
  atlas.mean.tetrahedra = { { { 0, 1, 2, 3 } }, { { 1, 0, 2, 4 } } };
  atlas.mean.neighbors = ComputeFaceNeighbors(atlas.mean.tetrahedra);
  atlas.mean.region = { 1, 2 };
  atlas.mean.degree = { 0, 0 };
  atlas.mean.maximumDegree = 0;
  atlas.mean.coefficients = { 1000, 100 };
  atlas.shape.mean = StackPoints(atlas.mean.points);
  atlas.shape.modes = Eigen::MatrixXd::Zero(15, 1);
  atlas.shape.modes(5, 0) = 1.0; // the second point along z
  atlas.shape.variances = Eigen::VectorXd::Constant(1, 4.0);
  atlas.density.mean = Eigen::Vector2d(1000, 100);
  atlas.density.modes = Eigen::MatrixXd::Identity(2, 2);
  atlas.density.variances = Eigen::VectorXd::Constant(2, 4.0);
  atlas.densityScores = Eigen::MatrixXd::Zero(5, 2);
  atlas.densityScores.col(0) << -1.5, -0.5, 0.5, 1.5, 0;
  atlas.densityScores(4, 1) = 2.5;
  return atlas;
}

DeformableModel
Model()
{
  DeformableRadiographParameters parameters;
  parameters.smoothModes = 0;
  return { Atlas(), parameters };
}

TEST(DeformableModel, HasAModeForEachRegionOfWhatOtherSubjectsLeave)
{
  const DeformableModel model = Model();
  EXPECT_EQ(model.shapeModes, 1);
  ASSERT_EQ(model.densityModes, 3); // the atlas' two, and the second region's: nothing is left of the first
  EXPECT_NEAR(model.densities[2][0], 0.0, 1e-9);
  EXPECT_NEAR(model.densities[2][1], std::sqrt(25.0 / 5.0), 1e-9);
}

TEST(DeformableModel, SynthesizesByStandardDeviations)
{
  const DeformableModel model = Model();
  const MeshArrays      mesh = model.Synthesize(Eigen::Vector4d(0.5, 1.0, 0.0, 2.0));
  EXPECT_EQ(mesh.points[1], Vector3(1, 0, 1));
  EXPECT_EQ(mesh.points[2], Vector3(0, 2, 0));
  EXPECT_NEAR(mesh.coefficients[0], 1002.0, 1e-9);
  EXPECT_NEAR(mesh.coefficients[1], 100.0 + 2.0 * std::sqrt(5.0), 1e-9);
}

TEST(DeformableModel, MeasuresRegionsAndTheWhole)
{
  const Eigen::MatrixXd at = Model().MeasureRegions(Eigen::Vector4d(0, 1.0, 0, 0));
  ASSERT_EQ(at.rows(), 4);
  EXPECT_NEAR(at(1, 0), 1.0, 1e-12);
  EXPECT_NEAR(at(1, 1), 1002.0, 1e-9);
  EXPECT_NEAR(at(2, 0), 2.0, 1e-12);
  EXPECT_NEAR(at(2, 2), 200.0, 1e-9);
  EXPECT_NEAR(at(3, 0), 3.0, 1e-12);
  EXPECT_NEAR(at(3, 1), 1202.0 / 3.0, 1e-9);
  EXPECT_EQ(at(0, 0), 0.0);
}
} // namespace
