/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDeformableModel.h"

#include "boneDeformableTestAtlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace DeformableModelTests
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

TEST(DeformableModel, TellsHowRegionsRiseWithEachCoefficient)
{
  constexpr double               step = 1e-4;
  DeformableRadiographParameters parameters;
  parameters.smoothModes = 0;
  const DeformableModel model(test::Atlas(), parameters);
  const auto            count = model.GetNumberOfCoefficients();
  const Eigen::VectorXd at = Eigen::VectorXd::LinSpaced(count, -0.5, 0.7);
  const auto            slopes = model.RegionSlopes(at);
  ASSERT_EQ(static_cast<Eigen::Index>(slopes.size()), count);
  for (Eigen::Index k = 0; k < count; ++k)
  {
    const Eigen::VectorXd move = step * Eigen::VectorXd::Unit(count, k);
    const Eigen::MatrixXd difference =
      (model.MeasureRegions(at + move) - model.MeasureRegions(at - move)) / (2.0 * step);
    const Eigen::MatrixXd & slope = slopes[static_cast<std::size_t>(k)];
    for (Eigen::Index c = 0; c < slope.cols(); ++c) // each of its own size
    {
      EXPECT_LE((slope.col(c) - difference.col(c)).norm(), 1e-6 * (0.1 + difference.col(c).norm())) << k << ' ' << c;
    }
  }
}

TEST(DeformableModel, CoarsensAndKeepsTheModesOfThePointsThatStay)
{
  StatisticalModelContent atlas = test::Atlas();
  atlas.mean = test::BallMesh(12, Vector3(10, 20, 30), 20.0);
  atlas.mean.degree.assign(atlas.mean.tetrahedra.size(), 0);
  atlas.mean.maximumDegree = 0;
  atlas.mean.coefficients.assign(atlas.mean.tetrahedra.size(), 500.0);
  const Eigen::VectorXd mean = StackPoints(atlas.mean.points);
  atlas.shape = test::ModesOf(mean, Eigen::MatrixXd::Random(mean.size(), 2));
  atlas.density = PrincipalModes();
  atlas.densityScores.resize(0, 0);
  DeformableRadiographParameters parameters;
  parameters.smoothModes = 0;
  const DeformableModel model(atlas, parameters);
  const std::size_t     asked = model.mean.tetrahedra.size() / 3;
  const CoarseModel     coarse = model.Coarsen(asked, 2, Execution());
  EXPECT_LT(coarse.mesh.tetrahedra.size(), 1.2 * static_cast<double>(asked));
  EXPECT_EQ(coarse.mesh.maximumDegree, 0);
  EXPECT_EQ(coarse.mesh.coefficients.size(), coarse.mesh.tetrahedra.size());
  ASSERT_EQ(coarse.displacements.size(), 2u);
  const Eigen::VectorXd coefficients = Eigen::Vector2d(0.8, -1.2);
  const auto            whole = model.MovePoints(coefficients);
  const auto            moved = coarse.MovePoints(coefficients);
  ASSERT_EQ(moved.size(), coarse.mesh.points.size());
  for (std::size_t i = 0; i < moved.size(); ++i)
  {
    const auto at = std::find(model.mean.points.begin(), model.mean.points.end(), coarse.mesh.points[i]);
    ASSERT_NE(at, model.mean.points.end());
    EXPECT_LT((moved[i] - whole[static_cast<std::size_t>(at - model.mean.points.begin())]).norm(), 1e-12);
  }
  // As fine as it is, and one mode alone.
  const CoarseModel same = model.Coarsen(model.mean.tetrahedra.size(), 1, Execution());
  EXPECT_EQ(same.mesh.tetrahedra, model.mean.tetrahedra);
  EXPECT_EQ(same.mesh.coefficients, model.meanDensities);
  EXPECT_EQ(same.displacements.size(), 1u);
}
} // namespace DeformableModelTests
