/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModelEvaluation.h"

#include "boneAtlasTestPopulation.h"
#include "boneStatisticalModel.h"

#include <Eigen/SVD>
#include <gtest/gtest.h>

namespace ModelEvaluationTests
{
using namespace bone;
using namespace bone::test;

std::vector<std::vector<Vector3>>
Shapes(unsigned count)
{
  std::vector<std::vector<Vector3>> shapes;
  for (const MeshArrays & subject : MakePopulation(count, -1))
  {
    shapes.push_back(subject.points);
  }
  return shapes;
}

CoefficientPass
PassOver(const std::vector<MeshArrays> & subjects)
{
  return [&subjects](const std::function<void(const std::vector<double> &)> & visit) {
    for (const MeshArrays & subject : subjects)
    {
      visit(subject.coefficients);
    }
  };
}

TEST(ModelEvaluation, ErrorsFallWithModesToTheNoise)
{
  EvaluationParameters parameters;
  parameters.modes = { 0, 1, 3, 6, 99 };
  parameters.samples = 20;
  const auto quality = EvaluateShapes(Shapes(12), parameters);
  ASSERT_EQ(quality.size(), 4u); // 99 modes there are not
  for (std::size_t m = 1; m < quality.size(); ++m)
  {
    EXPECT_LT(quality[m].generalisation.mean, quality[m - 1].generalisation.mean + 1e-12);
    EXPECT_GE(quality[m].compactness, quality[m - 1].compactness);
  }
  EXPECT_EQ(quality[0].compactness, 0.0);
  EXPECT_GT(quality[0].generalisation.mean, 0.3);
  EXPECT_LT(quality[2].generalisation.mean, 0.1); // three true modes and their quadratic terms
  EXPECT_GT(quality[0].generalisation.standardError, 0.0);
  EXPECT_GT(quality[2].specificity.mean, quality[0].specificity.mean * 0.1);
}

TEST(ModelEvaluation, DoesNotDependOnPose)
{
  auto       shapes = Shapes(6);
  const auto still = EvaluateShapes(shapes, EvaluationParameters());
  for (unsigned i = 0; i < shapes.size(); ++i)
  {
    Move(RandomPose(i + 10), shapes[i]);
  }
  const auto moved = EvaluateShapes(shapes, EvaluationParameters());
  for (std::size_t m = 0; m < still.size(); ++m)
  {
    EXPECT_NEAR(still[m].generalisation.mean, moved[m].generalisation.mean, 1e-8);
  }
}

TEST(ModelEvaluation, TheModelOfTheOthersIsTheirs)
{
  const auto           shapes = Shapes(9);
  EvaluationParameters parameters;
  parameters.modes = { 0, 2, 5, 7 };
  parameters.alignment = AlignmentKind::None;
  parameters.samples = 0;
  std::vector<std::vector<double>> errors(parameters.modes.size());
  for (std::size_t left = 0; left < shapes.size(); ++left)
  {
    Eigen::MatrixXd others(StackPoints(shapes[0]).size(), shapes.size() - 1);
    for (std::size_t i = 0, column = 0; i < shapes.size(); ++i)
    {
      if (i != left)
      {
        others.col(static_cast<Eigen::Index>(column++)) = StackPoints(shapes[i]);
      }
    }
    const Eigen::VectorXd                   mean = others.rowwise().mean(), y = StackPoints(shapes[left]);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(others.colwise() - mean, Eigen::ComputeThinU);
    for (std::size_t m = 0; m < parameters.modes.size(); ++m)
    {
      const auto            modes = svd.matrixU().leftCols(parameters.modes[m]);
      const Eigen::VectorXd rest = (y - mean) - modes * (modes.transpose() * (y - mean));
      errors[m].push_back(rest.reshaped(3, rest.size() / 3).colwise().norm().mean());
    }
  }
  const auto quality = EvaluateShapes(shapes, parameters);
  for (std::size_t m = 0; m < parameters.modes.size(); ++m)
  {
    EXPECT_NEAR(quality[m].generalisation.mean, Summarize(errors[m]).mean, 1e-9) << m;
    EXPECT_NEAR(quality[m].generalisation.standardError, Summarize(errors[m]).standardError, 1e-9) << m;
  }
}

TEST(ModelEvaluation, DensitiesOfKnownPatternsAreReached)
{
  const auto           subjects = MakePopulation(8);
  EvaluationParameters parameters;
  parameters.modes = { 0, 3 };
  const auto quality = EvaluateDensities(subjects[0], subjects.size(), PassOver(subjects), parameters);
  EXPECT_GT(quality[0].rootMeanSquare.mean, 10.0);
  EXPECT_LT(quality[1].rootMeanSquare.mean, 1e-6);
  EXPECT_NEAR(quality[1].compactness, 1.0, 1e-9);
}

TEST(ModelEvaluation, AConstantDifferenceIsItsBias)
{
  const auto            subject = MakeSubject(1);
  const Eigen::VectorXd a = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(subject.coefficients.size()), 7.0);
  const auto            difference = CompareDensities(subject, a, Eigen::VectorXd::Constant(a.size(), 10.0));
  EXPECT_NEAR(difference.bias, -3.0, 1e-9);
  EXPECT_NEAR(difference.meanAbsolute, 3.0, 1e-9);
  EXPECT_NEAR(difference.rootMeanSquare, 3.0, 1e-9);
  EXPECT_THROW(CompareDensities(subject, a, a.head(3)), std::invalid_argument);
}

TEST(ModelEvaluation, NeedsThreeSubjects)
{
  EXPECT_THROW(EvaluateShapes(Shapes(2), EvaluationParameters()), std::invalid_argument);
}

TEST(ModelEvaluation, StandardErrorOfKnownValues)
{
  const auto summary = Summarize({ 1, 2, 3, 4 });
  EXPECT_NEAR(summary.mean, 2.5, 1e-15);
  EXPECT_NEAR(summary.standardError, std::sqrt(5.0 / 3.0 / 4.0), 1e-12);
}
} // namespace ModelEvaluationTests
