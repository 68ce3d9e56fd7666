/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStatisticalModel.h"

#include <Eigen/LU>
#include <Eigen/QR>

#include <gtest/gtest.h>

namespace StatisticalModelTests
{
bone::PrincipalModes
RandomModes(Eigen::Index d, Eigen::Index k)
{
  std::srand(3);
  bone::PrincipalModes model;
  model.mean = Eigen::VectorXd::Random(d) * 10;
  const Eigen::MatrixXd random = Eigen::MatrixXd::Random(d, k);
  model.modes = Eigen::HouseholderQR<Eigen::MatrixXd>(random).householderQ() * Eigen::MatrixXd::Identity(d, k);
  model.variances = Eigen::VectorXd::LinSpaced(k, static_cast<double>(k), 1.0).array().square();
  model.totalVariance = model.variances.sum();
  return model;
}

TEST(PrincipalModes, SampleYieldsItsCoefficients)
{
  const auto model = RandomModes(30, 6);
  const auto b = bone::SampleCoefficients(6, 17);
  EXPECT_LT((model.Project(model.Synthesize(b)) - b).norm(), 1e-12);
  EXPECT_EQ(b, bone::SampleCoefficients(6, 17));
  EXPECT_NE(b, bone::SampleCoefficients(6, 18));
}

TEST(PrincipalModes, FewerCoefficientsLeaveTheRestAtZero)
{
  const auto      model = RandomModes(30, 6);
  Eigen::VectorXd six = bone::SampleCoefficients(6, 1);
  six.tail(3).setZero();
  EXPECT_LT((model.Synthesize(six.head(3)) - model.Synthesize(six)).norm(), 1e-12);
  EXPECT_LT((model.Synthesize(Eigen::VectorXd()) - model.mean).norm(), 1e-15);
  EXPECT_THROW(model.Synthesize(Eigen::VectorXd::Zero(7)), std::invalid_argument);
  EXPECT_THROW(model.Project(Eigen::VectorXd::Zero(7)), std::invalid_argument);
}

TEST(PrincipalModes, PosteriorOfEverythingIsTheVectorItself)
{
  const auto                model = RandomModes(30, 6);
  const Eigen::VectorXd     y = model.Synthesize(bone::SampleCoefficients(6, 2));
  std::vector<Eigen::Index> all;
  for (Eigen::Index i = 0; i < y.size(); ++i)
  {
    all.push_back(i);
  }
  const auto posterior = model.Posterior(all, y, 1e-4);
  EXPECT_LT((posterior.mean - y).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(posterior.StandardDeviations().maxCoeff(), 1e-3);
}

TEST(PrincipalModes, PosteriorOfNothingIsThePrior)
{
  const auto model = RandomModes(30, 6);
  const auto posterior = model.Posterior({}, Eigen::VectorXd(), 1.0);
  EXPECT_LT((posterior.mean - model.mean).norm(), 1e-12);
  EXPECT_LT((posterior.variances - model.variances).norm(), 1e-10);
  EXPECT_LT((posterior.StandardDeviations() - model.StandardDeviations()).norm(), 1e-10);
}

/** Against the textbook's conditional of a Gaussian with the full covariance. */
TEST(PrincipalModes, PosteriorIsTheConditionalGaussian)
{
  const auto                      model = RandomModes(12, 5);
  const std::vector<Eigen::Index> seen = { 1, 4, 7 };
  Eigen::VectorXd                 values(3);
  values << 11, -4, 3;
  const double          noise = 0.3;
  const auto            posterior = model.Posterior(seen, values, noise);
  const Eigen::MatrixXd covariance = model.modes * model.variances.asDiagonal() * model.modes.transpose();
  Eigen::MatrixXd       cross(12, 3);
  Eigen::Matrix3d       inner;
  Eigen::Vector3d       residual;
  for (int i = 0; i < 3; ++i)
  {
    cross.col(i) = covariance.col(seen[i]);
    residual[i] = values[i] - model.mean[seen[i]];
    for (int j = 0; j < 3; ++j)
    {
      inner(i, j) = covariance(seen[i], seen[j]) + (i == j ? noise * noise : 0.0);
    }
  }
  const Eigen::MatrixXd gain = cross * inner.inverse();
  EXPECT_LT((posterior.mean - model.mean - gain * residual).norm(), 1e-9);
  const Eigen::MatrixXd expected = covariance - gain * cross.transpose();
  const Eigen::MatrixXd got = posterior.modes * posterior.variances.asDiagonal() * posterior.modes.transpose();
  EXPECT_LT((got - expected).norm(), 1e-9);
  EXPECT_THROW(model.Posterior(seen, values, 0.0), std::invalid_argument);
  EXPECT_THROW(model.Posterior({ 1, 4, 12 }, values, 1.0), std::invalid_argument);
}

TEST(PrincipalModes, LimitsOfCoefficients)
{
  Eigen::VectorXd b(3), box(3);
  b << 4, -5, 1;
  box << 3, -3, 1;
  EXPECT_EQ(bone::ClampToBox(b), box);
  const Eigen::VectorXd ball = bone::ClampToBall(b, 0.95);
  EXPECT_NEAR(ball.norm(), std::sqrt(7.814728), 1e-5); // tables of chi squared, 3 degrees of freedom
  EXPECT_NEAR(ball.dot(b), ball.norm() * b.norm(), 1e-12);
  EXPECT_LT((bone::ClampToBall(0.1 * b, 0.95) - 0.1 * b).norm(), 1e-15);
  EXPECT_THROW(bone::ClampToBall(b, 1.0), std::invalid_argument);
}

TEST(PrincipalModes, SamplesAreStandardNormal)
{
  const Eigen::VectorXd b = bone::SampleCoefficients(20000, 5);
  EXPECT_NEAR(b.mean(), 0.0, 0.02);
  EXPECT_NEAR(b.squaredNorm() / 20000.0, 1.0, 0.03);
}

TEST(StatisticalModel, RefusesContentThatDoesNotMatch)
{
  bone::StatisticalModelContent content;
  content.mean.points.resize(10);
  content.shape = RandomModes(30, 4);
  auto model = bone::StatisticalModel::New();
  model->SetContent(content);
  EXPECT_FALSE(model->HasDensity());
  EXPECT_EQ(model->Synthesize(Eigen::VectorXd::Zero(4)).points.size(), 10u);
  EXPECT_THROW(model->Synthesize(Eigen::VectorXd::Zero(5)), itk::ExceptionObject);
  EXPECT_THROW(model->Synthesize(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1)), itk::ExceptionObject);
  content.mean.points.resize(9);
  EXPECT_THROW(model->SetContent(content), itk::ExceptionObject);
  auto graft = bone::StatisticalModel::New();
  graft->Graft(model);
  EXPECT_EQ(graft->GetContent().shape.GetNumberOfModes(), 4);
}
} // namespace StatisticalModelTests
