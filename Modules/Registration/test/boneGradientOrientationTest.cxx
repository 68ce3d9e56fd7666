/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneGradientOrientation.h"

#include "boneImageGradient.h"
#include "boneMetricTestImages.h"
#include "boneSymmetricEigen.h"

#include <gtest/gtest.h>

#include <limits>

namespace GradientOrientationTests
{
using namespace bone;

constexpr int Columns = 40;
constexpr int Rows = 30;

using Image = std::vector<float>;

Image
Waves(unsigned int seed)
{
  return RandomWaves(Columns, Rows, seed, 1.0);
}

RadiographView
Target(unsigned int seed)
{
  RadiographView target;
  target.view.size = { { Columns, Rows } };
  target.values = Waves(seed);
  return target;
}

Image
Scaled(Image image, float factor, float offset)
{
  for (float & value : image)
  {
    value = factor * value + offset;
  }
  return image;
}

/** The components u of all pixels that count, one after the other. */
Eigen::VectorXd
Directions(const Image & image, double threshold)
{
  const ImageGradient gradient(Columns, Rows, 1.0);
  Image               x(image.size());
  Image               y(image.size());
  gradient.Apply(image.data(), x.data(), y.data());
  const int                    radius = gradient.Radius();
  std::vector<Eigen::Vector2d> gradients;
  double                       squares = 0.0;
  for (int r = radius; r < Rows - radius; ++r)
  {
    for (int c = radius; c < Columns - radius; ++c)
    {
      gradients.emplace_back(x[static_cast<std::size_t>(r * Columns + c)],
                             y[static_cast<std::size_t>(r * Columns + c)]);
      squares += gradients.back().squaredNorm();
    }
  }
  const double    square = threshold * threshold * squares / static_cast<double>(gradients.size());
  Eigen::VectorXd directions(2 * static_cast<Eigen::Index>(gradients.size()));
  for (std::size_t i = 0; i < gradients.size(); ++i)
  {
    directions.segment<2>(2 * static_cast<Eigen::Index>(i)) =
      gradients[i] / std::sqrt(gradients[i].squaredNorm() + square);
  }
  return directions;
}

TEST(GradientOrientation, IsWhatItsDefinitionSays)
{
  const Image           image = Waves(2);
  const Eigen::VectorXd f = Directions(Waves(1), 0.3);
  const Eigen::VectorXd g = Directions(image, 0.3);
  EXPECT_NEAR(
    GradientOrientation(Target(1), 1.0, 0.3).Evaluate(image.data()), 1.0 - f.dot(g) / (f.norm() * g.norm()), 1e-6);
}

TEST(GradientOrientation, IsNothingForTheSameImageWhateverItsScaleAndOffset)
{
  const GradientOrientation metric(Target(1), 1.0);
  EXPECT_NEAR(metric.Evaluate(Scaled(Waves(1), 20.0f, 7.0f).data()), 0.0, 1e-5);
  EXPECT_NEAR(metric.Evaluate(Scaled(Waves(1), -1.0f, 0.0f).data()), 2.0, 1e-5);
}

TEST(GradientOrientation, IsAboutOneForUnlikeImagesAndOneForAConstant)
{
  double sum = 0.0;
  for (unsigned int seed = 2; seed < 22; ++seed)
  {
    sum += GradientOrientation(Target(1), 1.0).Evaluate(Waves(seed).data());
  }
  EXPECT_NEAR(sum / 20.0, 1.0, 0.1);
  std::vector<Image> images{ Image(Columns * Rows, 5.0f), Waves(1) };
  const MetricValue  value = GradientOrientation(Target(1), 1.0).EvaluateDerivatives(PointersTo(images));
  EXPECT_DOUBLE_EQ(value.cost, 1.0);
  EXPECT_DOUBLE_EQ(value.gradient.norm(), 0.0);
  EXPECT_DOUBLE_EQ(value.shares.norm(), 0.0);
}

TEST(GradientOrientation, TheXRaysScaleDoesNotMatter)
{
  RadiographView     target = Target(1);
  std::vector<Image> images{ Waves(2), Waves(3) };
  const MetricValue  value = GradientOrientation(target, 1.0).EvaluateDerivatives(PointersTo(images));
  target.values = Scaled(target.values, 0.01f, 3.0f);
  const MetricValue other = GradientOrientation(target, 1.0).EvaluateDerivatives(PointersTo(images));
  EXPECT_NEAR(other.cost, value.cost, 1e-5);
  EXPECT_NEAR(other.gradient[0], value.gradient[0], 1e-3 * std::abs(value.gradient[0]));
}

TEST(GradientOrientation, ARisingFunctionOfTheXRayMattersLittle)
{
  RadiographView target = Target(1);
  for (float & value : target.values)
  {
    value = std::exp(0.3f * value);
  }
  EXPECT_LT(GradientOrientation(target, 1.0, 0.1).Evaluate(Waves(1).data()), 0.03);
}

TEST(GradientOrientation, GradientAgreesWithDifferences)
{
  for (double threshold : { 0.1, 0.5, 3.0 })
  {
    const GradientOrientation metric(Target(1), 1.0, threshold);
    const Image               image = Waves(2);
    // The last two change the root mean square of the radiograph's gradient.
    std::vector<Image> images{ image, Waves(3), Waves(1), Waves(2) };
    for (std::size_t i = 0; i < image.size(); ++i)
    {
      images[2][i] += image[i];
      images[3][i] *= 0.1f * static_cast<float>(i % Columns);
    }
    const MetricValue value = metric.EvaluateDerivatives(PointersTo(images));
    EXPECT_DOUBLE_EQ(value.cost, metric.Evaluate(image.data()));
    for (int k = 0; k < 3; ++k)
    {
      const double difference = CentralDifference(metric, image, images[static_cast<std::size_t>(k) + 1], 2e-3);
      EXPECT_NEAR(value.gradient[k], difference, 1e-3 * value.gradient.norm());
    }
    ASSERT_EQ(value.shares.cols(), 3 * 2);
    EXPECT_LT((value.shares.rowwise().sum() - value.gradient).norm(), 1e-10);
  }
}

TEST(GradientOrientation, HessianIsThatOfTheCostWhereImagesAgree)
{
  const GradientOrientation metric(Target(1), 1.0);
  std::vector<Image>        images{ Waves(1), Waves(3) };
  const MetricValue         value = metric.EvaluateDerivatives(PointersTo(images));
  Image                     moved = images[0];
  for (std::size_t i = 0; i < moved.size(); ++i)
  {
    moved[i] += 0.02f * images[1][i];
  }
  const double cost = metric.Evaluate(moved.data());
  EXPECT_NEAR(0.5 * 0.02 * 0.02 * value.hessian(0, 0), cost, 0.05 * cost);
  EXPECT_LT(value.shares.norm(), 1e-4 * value.hessian(0, 0));
}

TEST(GradientOrientation, HessianIsPositiveSemidefiniteForDependentDerivatives)
{
  const GradientOrientation metric(Target(1), 1.0);
  std::vector<Image>        images{ Waves(2), Waves(3), Waves(4), Waves(3), Waves(2) };
  const auto eigen = EigenOf<Eigen::Dynamic>(metric.EvaluateDerivatives(PointersTo(images)).hessian).values;
  EXPECT_GT(eigen.maxCoeff(), 0.0);
  EXPECT_GT(eigen.minCoeff(), -1e-6 * eigen.maxCoeff());
}

TEST(GradientOrientation, PixelsWithoutWeightDoNotCount)
{
  RadiographView target = Target(1);
  target.weights.assign(target.values.size(), 1.0f);
  std::vector<Image> images{ Waves(1), Waves(3) };
  for (int r = 10; r < 14; ++r)
  {
    for (int c = 5; c < 12; ++c)
    {
      target.weights[static_cast<std::size_t>(r * Columns + c)] = 0.0f;
    }
  }
  const MetricValue value = GradientOrientation(target, 1.0).EvaluateDerivatives(PointersTo(images));
  for (std::size_t i = 0; i < target.weights.size(); ++i)
  {
    if (target.weights[i] == 0.0f)
    {
      target.values[i] = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : 1e4f;
      images[0][i] = images[1][i] = target.values[i];
    }
  }
  const MetricValue other = GradientOrientation(target, 1.0).EvaluateDerivatives(PointersTo(images));
  EXPECT_EQ(value.cost, other.cost);
  EXPECT_EQ(value.gradient, other.gradient);
  EXPECT_EQ(value.hessian, other.hessian);
}

TEST(GradientOrientation, RefusesWhatTellsNothing)
{
  RadiographView target = Target(1);
  for (double wrong : { 0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() })
  {
    EXPECT_THROW(GradientOrientation(target, wrong, 0.5), std::invalid_argument);
    EXPECT_THROW(GradientOrientation(target, 1.0, wrong), std::invalid_argument);
  }
  RadiographView constant = target;
  std::fill(constant.values.begin(), constant.values.end(), 3.0f);
  EXPECT_THROW(GradientOrientation(constant, 1.0), std::invalid_argument);
  RadiographView notFinite = target;
  notFinite.values[500] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(GradientOrientation(notFinite, 1.0), std::invalid_argument);
  target.weights.assign(target.values.size(), 0.0f);
  EXPECT_THROW(GradientOrientation(target, 1.0), std::invalid_argument);
  target = Target(1);
  target.values.pop_back();
  EXPECT_THROW(GradientOrientation(target, 1.0), std::invalid_argument);
}
} // namespace GradientOrientationTests
