/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSubjectEvaluation.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace SubjectEvaluationTests
{
using namespace bone;

/** Two tetrahedra; a mode that moves the third point out by 2 mm and one that moves the last down by 1 mm, cleared of
 * rigid motions, and one of density of 50 HU in each cell. */
StatisticalModelContent
Atlas()
{
  StatisticalModelContent atlas;
  atlas.mean.points = { { -30, -20, 0 }, { 30, -20, 0 }, { 0, 40, 0 }, { 0, 0, 30 }, { 0, 0, -30 } };
  atlas.mean.tetrahedra = { { { 0, 1, 2, 3 } }, { { 1, 0, 2, 4 } } };
  atlas.mean.neighbors = ComputeFaceNeighbors(atlas.mean.tetrahedra);
  atlas.mean.degree = { 0, 0 };
  atlas.mean.maximumDegree = 0;
  atlas.mean.coefficients = { 1000, 100 };
  atlas.shape.mean = StackPoints(atlas.mean.points);
  atlas.shape.modes = Eigen::MatrixXd::Zero(15, 2);
  for (Eigen::Index p = 0; p < 5; ++p)
  {
    atlas.shape.modes.block<3, 1>(3 * p, 0) = atlas.mean.points[static_cast<std::size_t>(p)]; // size
  }
  atlas.shape.modes(11, 1) = 1.0; // the ends apart
  atlas.shape.modes(14, 1) = -1.0;
  atlas.shape.modes.col(1) -=
    atlas.shape.modes.col(0).normalized().dot(atlas.shape.modes.col(1)) * atlas.shape.modes.col(0).normalized();
  atlas.shape.modes.colwise().normalize();
  atlas.shape.variances = Eigen::Vector2d(9.0, 4.0);
  atlas.shape.totalVariance = 13.0;
  atlas.density.mean = Eigen::Vector2d(1000, 100);
  atlas.density.modes = Eigen::Vector2d(1, 1).normalized();
  atlas.density.variances = Eigen::VectorXd::Constant(1, 5000.0);
  atlas.shapeScores = Eigen::MatrixXd::Zero(3, 2);
  return atlas;
}

MeshArrays
Subject(const StatisticalModelContent & atlas, const Eigen::Vector2d & scores, double density)
{
  MeshArrays            mesh = atlas.mean;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3(1, 2, -1).normalized()).toRotationMatrix();
  mesh.points = UnstackPoints(atlas.shape.Synthesize(scores));
  for (Vector3 & x : mesh.points)
  {
    x = turn * x + Vector3(100, -20, 7);
  }
  const Eigen::VectorXd c = atlas.density.Synthesize(Eigen::VectorXd::Constant(1, density));
  mesh.coefficients.assign(c.data(), c.data() + c.size());
  return mesh;
}

TEST(SubjectEvaluation, TellsTheCoefficientsOfASampleWhereverItLies)
{
  const auto atlas = Atlas();
  const auto result = EvaluateSubject(atlas, Subject(atlas, { 1.5, -0.8 }, 2.0));
  EXPECT_NEAR(result.shape.scores[0], 1.5, 1e-6);
  EXPECT_NEAR(result.shape.scores[1], -0.8, 1e-6);
  EXPECT_NEAR(result.shape.distance, 1.7, 1e-6);
  EXPECT_NEAR(result.shape.probability, std::exp(-0.5 * 1.7 * 1.7), 1e-6); // chi-squared of two degrees of freedom
  EXPECT_NEAR(result.shapeResidual, 0.0, 1e-6);
  ASSERT_TRUE(result.hasDensity);
  EXPECT_NEAR(result.density.scores[0], 2.0, 1e-9);
  EXPECT_NEAR(result.density.probability, 0.0455, 1e-4); // beyond two standard deviations
  EXPECT_NEAR(result.densityResidual.rootMeanSquare, 0.0, 1e-9);
}

TEST(SubjectEvaluation, WhatNoModeMakesIsTheResidual)
{
  const auto atlas = Atlas();
  MeshArrays mesh = Subject(atlas, { 0.0, 0.0 }, 0.0);
  mesh.coefficients = { 1030, 70 }; // the mode makes both rise
  const auto result = EvaluateSubject(atlas, mesh);
  EXPECT_NEAR(result.density.scores[0], 0.0, 1e-9);
  EXPECT_NEAR(result.densityResidual.meanAbsolute, 30.0, 1e-9);
  mesh = atlas.mean;
  mesh.points[0] += Vector3(-5, 5, 0);
  mesh.points[1] += Vector3(5, 5, 0);
  EXPECT_GT(EvaluateSubject(atlas, mesh).shapeResidual, 1.0);
}

TEST(SubjectEvaluation, RefusesAnotherTopologyOrDegree)
{
  const auto atlas = Atlas();
  MeshArrays mesh = atlas.mean;
  std::swap(mesh.tetrahedra[0][1], mesh.tetrahedra[0][2]);
  EXPECT_THROW(EvaluateSubject(atlas, mesh), std::invalid_argument);
  mesh = atlas.mean;
  mesh.maximumDegree = 1;
  mesh.coefficients.assign(8, 500.0);
  EXPECT_THROW(EvaluateSubject(atlas, mesh), std::invalid_argument);
  mesh.maximumDegree = -1;
  mesh.coefficients.clear();
  EXPECT_FALSE(EvaluateSubject(atlas, mesh).hasDensity);
}
} // namespace SubjectEvaluationTests
