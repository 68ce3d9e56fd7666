/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePatchGradientCorrelation.h"

#include "boneImageGradient.h"
#include "boneMetricTestImages.h"
#include "boneSymmetricEigen.h"

#include <gtest/gtest.h>

#include <limits>

namespace PatchGradientCorrelationTests
{
using namespace bone;

constexpr int Columns = 40;
constexpr int Rows = 30;
constexpr int Patch = 8;

std::vector<float>
Waves(unsigned int seed)
{
  return RandomWaves(Columns, Rows, seed, 100.0);
}

RadiographView
Target(unsigned int seed)
{
  RadiographView target;
  target.view.size = { { Columns, Rows } };
  target.values = Waves(seed);
  return target;
}

/** The cost's definition, patch by patch. */
double
CostByDefinition(const std::vector<float> & f, const std::vector<float> & g)
{
  const ImageGradient gradient(Columns, Rows, 1.0);
  std::vector<float>  d[2][2];
  for (int image = 0; image < 2; ++image)
  {
    d[image][0].resize(Columns * Rows);
    d[image][1].resize(Columns * Rows);
    gradient.Apply((image == 0 ? f : g).data(), d[image][0].data(), d[image][1].data());
  }
  const int r = gradient.Radius();
  double    shared = 0.0, norms = 0.0;
  for (int y = 0; y < Rows - Patch / 2; y += Patch / 2)
  {
    for (int x = 0; x < Columns - Patch / 2; x += Patch / 2)
    {
      double products[3] = {};
      for (int axis = 0; axis < 2; ++axis)
      {
        std::vector<double> a, b;
        for (int row = std::max(y, r); row < std::min(y + Patch, Rows - r); ++row)
        {
          for (int column = std::max(x, r); column < std::min(x + Patch, Columns - r); ++column)
          {
            a.push_back(d[0][axis][static_cast<std::size_t>(row * Columns + column)]);
            b.push_back(d[1][axis][static_cast<std::size_t>(row * Columns + column)]);
          }
        }
        double meanA = 0.0, meanB = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i)
        {
          meanA += a[i] / static_cast<double>(a.size());
          meanB += b[i] / static_cast<double>(a.size());
        }
        for (std::size_t i = 0; i < a.size(); ++i)
        {
          products[0] += (a[i] - meanA) * (a[i] - meanA);
          products[1] += (a[i] - meanA) * (b[i] - meanB);
          products[2] += (b[i] - meanB) * (b[i] - meanB);
        }
      }
      shared += products[1] / std::sqrt(products[0]);
      norms += std::sqrt(products[2]);
    }
  }
  return 1.0 - shared / norms;
}

TEST(PatchGradientCorrelation, IsWhatItsDefinitionSays)
{
  const PatchGradientCorrelation metric(Target(1), Patch, 1.0);
  const auto                     image = Waves(2);
  EXPECT_NEAR(metric.Evaluate(image.data()), CostByDefinition(Waves(1), image), 1e-4);
}

TEST(PatchGradientCorrelation, IsNothingForTheSameImageWhateverItsScaleAndOffset)
{
  const PatchGradientCorrelation metric(Target(1), Patch, 1.0);
  auto                           image = Waves(1);
  for (float & value : image)
  {
    value = 0.01f * value + 7.0f;
  }
  EXPECT_NEAR(metric.Evaluate(image.data()), 0.0, 1e-4);
  for (float & value : image)
  {
    value = -value;
  }
  EXPECT_NEAR(metric.Evaluate(image.data()), 2.0, 1e-4);
}

TEST(PatchGradientCorrelation, IsOneForAnImageOfNothing)
{
  const PatchGradientCorrelation metric(Target(1), Patch, 1.0);
  const std::vector<float>       nothing(Columns * Rows, 5.0f);
  EXPECT_DOUBLE_EQ(metric.Evaluate(nothing.data()), 1.0);
}

TEST(PatchGradientCorrelation, GradientAgreesWithDifferences)
{
  const PatchGradientCorrelation  metric(Target(1), Patch, 1.0);
  const auto                      image = Waves(2);
  std::vector<std::vector<float>> images{ image, Waves(3), Waves(4), Waves(1) };
  const MetricValue               value = metric.EvaluateDerivatives(PointersTo(images));
  EXPECT_DOUBLE_EQ(value.cost, metric.Evaluate(image.data()));
  for (int k = 0; k < 3; ++k)
  {
    const double difference = CentralDifference(metric, image, images[static_cast<std::size_t>(k) + 1], 0.01);
    EXPECT_NEAR(value.gradient[k], difference, 1e-3 * std::abs(value.gradient[k]) + 1e-4);
  }
  EXPECT_LT((value.shares.rowwise().sum() - value.gradient).norm(), 1e-10);
  EXPECT_GT(EigenOf<Eigen::Dynamic>(value.hessian).values[0], 0.0);
}

TEST(PatchGradientCorrelation, HessianIsThatOfTheCostWhereImagesAgree)
{
  const PatchGradientCorrelation  metric(Target(1), Patch, 1.0);
  std::vector<std::vector<float>> images{ Waves(1), Waves(3) };
  const MetricValue               value = metric.EvaluateDerivatives({ images[0].data(), images[1].data() });
  auto                            moved = images[0];
  for (std::size_t i = 0; i < moved.size(); ++i)
  {
    moved[i] += 0.05f * images[1][i];
  }
  EXPECT_NEAR(
    value.hessian(0, 0) * 0.05 * 0.05 / 2.0, metric.Evaluate(moved.data()), 0.05 * metric.Evaluate(moved.data()));
}

TEST(PatchGradientCorrelation, PixelsWithoutWeightDoNotCount)
{
  RadiographView target = Target(1);
  target.weights.assign(target.values.size(), 1.0f);
  auto image = Waves(1);
  for (int r = 10; r < 14; ++r)
  {
    for (int c = 5; c < 12; ++c)
    {
      target.weights[static_cast<std::size_t>(r * Columns + c)] = 0.0f;
      image[static_cast<std::size_t>(r * Columns + c)] = 1e4f;
    }
  }
  EXPECT_NEAR(PatchGradientCorrelation(target, Patch, 1.0).Evaluate(image.data()), 0.0, 1e-4);
  target.values[11 * Columns + 7] = std::numeric_limits<float>::quiet_NaN();
  image[12 * Columns + 8] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NEAR(PatchGradientCorrelation(target, Patch, 1.0).Evaluate(image.data()), 0.0, 1e-4);
}

TEST(PatchGradientCorrelation, RefusesWhatTellsNothing)
{
  RadiographView target = Target(1);
  target.weights.assign(target.values.size(), 0.0f);
  EXPECT_THROW(PatchGradientCorrelation(target, Patch, 1.0), std::invalid_argument);
  RadiographView constant = Target(1);
  std::fill(constant.values.begin(), constant.values.end(), 3.0f);
  EXPECT_THROW(PatchGradientCorrelation(constant, Patch, 1.0), std::invalid_argument);
  RadiographView notFinite = Target(1);
  notFinite.values[500] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(PatchGradientCorrelation(notFinite, Patch, 1.0), std::invalid_argument);
}

TEST(PatchGradientCorrelation, CorrelationsAreOneWhereImagesAgree)
{
  const PatchGradientCorrelation metric(Target(1), Patch, 1.0);
  const auto                     image = Waves(1);
  const auto                     map = metric.Correlations(image.data());
  EXPECT_NEAR(map[15 * Columns + 20], 1.0, 1e-3);
}
} // namespace PatchGradientCorrelationTests
