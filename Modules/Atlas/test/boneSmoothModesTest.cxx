/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneResidualModes.h"
#include "boneSmoothModes.h"

#include <Eigen/QR>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace SmoothModesTests
{
using namespace bone;

/** Points at random in a box of 100 x 20 x 20 mm. */
std::vector<Vector3>
Points(int count)
{
  std::mt19937                           random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Vector3>                   points;
  for (int i = 0; i < count; ++i)
  {
    points.emplace_back(100.0 * uniform(random), 20.0 * uniform(random), 20.0 * uniform(random));
  }
  return points;
}

/** Covariance of the modes' displacements of two points along an axis. */
double
CovarianceOf(const PrincipalModes & modes, Eigen::Index p, Eigen::Index q, Eigen::Index axis, Eigen::Index other)
{
  return (modes.modes.row(3 * p + axis).cwiseProduct(modes.modes.row(3 * q + other))).dot(modes.variances);
}

TEST(SmoothModes, HaveTheCovarianceOfTheirGaussianProcess)
{
  const auto           points = Points(120);
  const PrincipalModes modes = SmoothModes(points, 1.5, 40.0, 300);
  for (Eigen::Index p = 0; p < 120; p += 17)
  {
    for (Eigen::Index q = 0; q < 120; q += 23)
    {
      const double d = (points[static_cast<std::size_t>(p)] - points[static_cast<std::size_t>(q)]).norm();
      EXPECT_NEAR(CovarianceOf(modes, p, q, 1, 1), 2.25 * std::exp(-d * d / 3200.0), 0.01);
      EXPECT_NEAR(CovarianceOf(modes, p, q, 0, 2), 0.0, 1e-12); // axes are independent
    }
  }
}

TEST(SmoothModes, AreOrthonormalAndTheLargestOfAll)
{
  const auto           points = Points(200);
  const PrincipalModes few = SmoothModes(points, 1.0, 30.0, 9);
  const PrincipalModes many = SmoothModes(points, 1.0, 30.0, 90);
  ASSERT_EQ(few.GetNumberOfModes(), 9);
  EXPECT_LT((few.modes.transpose() * few.modes - Eigen::MatrixXd::Identity(9, 9)).norm(), 1e-9);
  EXPECT_EQ(few.variances[0], few.variances[2]);
  EXPECT_GT(few.variances[2], few.variances[3]);
  for (Eigen::Index k = 0; k < 9; ++k)
  {
    EXPECT_NEAR(few.variances[k], many.variances[k], 0.02 * many.variances[k]);
  }
  EXPECT_EQ(few.totalVariance, 600.0);
  EXPECT_EQ(SmoothModes(points, 1.0, 30.0, 7).GetNumberOfModes(), 7);
  EXPECT_THROW(SmoothModes(points, 0.0, 30.0, 9), std::invalid_argument);
  EXPECT_THROW(SmoothModes(points, 1.0, NAN, 9), std::invalid_argument);
}

/** An atlas of subjects that vary along `directions`, each of length 1, by these amounts: #subjects by #directions. */
StatisticalModelContent
AtlasOf(const std::vector<Vector3> & points, const Eigen::MatrixXd & directions, const Eigen::MatrixXd & amounts)
{
  StatisticalModelContent atlas;
  atlas.mean.points = points;
  atlas.shape.mean = StackPoints(points);
  atlas.shape.modes = directions;
  atlas.shape.variances = Eigen::VectorXd::Constant(directions.cols(), 4.0);
  atlas.shape.totalVariance = atlas.shape.variances.sum();
  atlas.shapeScores = amounts / 2.0; // standard deviations
  return atlas;
}

TEST(ResidualModes, LeaveOneOutLeavesWhatNoOtherSubjectHas)
{
  // Four subjects vary along the first direction; the last alone has the second.
  PrincipalModes modes;
  modes.variances = Eigen::VectorXd::Constant(2, 4.0);
  Eigen::MatrixXd amounts(5, 2);
  amounts << -3, 0, -1, 0, 1, 0, 3, 0, 0, 5;
  const Eigen::MatrixXd left = LeaveOneOutResiduals(modes, amounts / 2.0);
  EXPECT_LT(left.leftCols(4).norm(), 1e-9);
  EXPECT_NEAR(left(0, 4), 0.0, 1e-9);
  EXPECT_NEAR(left(1, 4), 5.0, 1e-9);
}

TEST(ResidualModes, TotalVarianceIsOfAllThatIsLeft)
{
  // One subject of five has 10 mm in a direction of its own.
  const auto      points = Points(150);
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(450, 2);
  for (Eigen::Index p = 0; p < 150; ++p)
  {
    directions(3 * p + 1, 0) = p % 2 == 0 ? 1.0 : -1.0;
    directions(3 * p, 1) = 1.0;
  }
  directions /= std::sqrt(150.0);
  Eigen::MatrixXd amounts = Eigen::MatrixXd::Zero(5, 2);
  amounts.col(0) << -3, -1, 1, 3, 0;
  amounts(4, 1) = 10.0 * std::sqrt(150.0);
  const PrincipalModes modes = ResidualModes(AtlasOf(points, directions, amounts), 500.0, 30);
  EXPECT_NEAR(modes.totalVariance, 150.0 * 100.0 / 5.0, 1e-6);
  auto three = AtlasOf(points, directions, amounts.topRows(3));
  EXPECT_THROW(ResidualModes(three, 40.0, 9), std::invalid_argument);
}

/** Subjects in a space of as many directions as they span. */
StatisticalModelContent
AtlasOf(const std::vector<Vector3> & points, Eigen::MatrixXd shapes)
{
  shapes.colwise() -= shapes.rowwise().mean().eval();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(shapes.leftCols(shapes.cols() - 1));
  const Eigen::MatrixXd directions = qr.householderQ() * Eigen::MatrixXd::Identity(shapes.rows(), shapes.cols() - 1);
  return AtlasOf(points, directions, shapes.transpose() * directions);
}

TEST(ResidualModes, HaveTheVarianceOfTheSubjects)
{
  // Eight subjects of a smooth field of 2 mm: though the other seven make a part of each, its variance is found.
  const auto            points = Points(150);
  const PrincipalModes  field = SmoothModes(points, 2.0, 25.0, 30);
  const auto            atlas = AtlasOf(points, field.modes.leftCols(8));
  const Eigen::MatrixXd modes = ResidualModes(atlas, 25.0, 30).modes; // less rigid motions
  Eigen::MatrixXd       shapes(450, 8);
  for (Eigen::Index i = 0; i < shapes.cols(); ++i)
  {
    const Eigen::VectorXd standard = SampleCoefficients(field.GetNumberOfModes(), static_cast<std::uint64_t>(i + 1));
    shapes.col(i) = modes * field.variances.cwiseSqrt().cwiseProduct(standard);
  }
  const PrincipalModes  found = ResidualModes(AtlasOf(points, shapes), 25.0, 30);
  const Eigen::VectorXd size = modes.colwise().squaredNorm();
  const double          wanted = size.dot(field.variances);
  EXPECT_NEAR(size.dot(found.variances), wanted, 0.3 * wanted) << found.variances.transpose();
  for (int axis = 0; axis < 3; ++axis)
  {
    const Eigen::VectorXd shift = Vector3::Unit(axis).replicate(150, 1);
    EXPECT_LT((found.modes.transpose() * shift).norm(), 1e-9);
  }
}
} // namespace SmoothModesTests
