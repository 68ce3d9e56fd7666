/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneIntensityDifference.h"

#include "boneBackgroundSpline.h"
#include "boneMetricTestImages.h"
#include "boneSymmetricEigen.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <random>

namespace IntensityDifferenceTests
{
using namespace bone;

constexpr int Columns = 40;
constexpr int Rows = 30;

using Image = std::vector<float>;

Image
Waves(unsigned int seed, double height = 1.0)
{
  return RandomWaves(Columns, Rows, seed, height);
}

/** An X-ray of a radiograph, seen with a gain, a wave of background and noise. */
RadiographView
Target(const Image & image, double gain = 1.0, double noise = 0.05)
{
  std::mt19937                     random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  RadiographView                   target;
  target.view.size = { { Columns, Rows } };
  for (std::size_t i = 0; i < image.size(); ++i)
  {
    target.values.push_back(static_cast<float>(gain * image[i] + noise * normal(random)));
  }
  return target;
}

/** Some background, a gain or none, and few outliers' loss. */
IntensityDifferenceParameters
Parameters(double knotSpacing, double gainDeviation)
{
  IntensityDifferenceParameters parameters;
  parameters.scale = 0.2;
  parameters.knotSpacing = knotSpacing;
  parameters.gainDeviation = gainDeviation;
  return parameters;
}

/** The B-splines and, with a prior for the gain, the radiograph: #pixels by #unknowns. */
Eigen::MatrixXd
Basis(const IntensityDifferenceParameters & parameters, const Image & image)
{
  const BackgroundSpline spline({ { Columns, Rows } }, parameters.knotSpacing);
  const Eigen::Index     knots = spline.GetNumberOfCoefficients();
  Eigen::MatrixXd        basis(Columns * Rows, knots + (parameters.gainDeviation > 0.0 ? 1 : 0));
  for (Eigen::Index k = 0; k < knots; ++k)
  {
    for (int r = 0; r < Rows; ++r)
    {
      spline.Evaluate(r, Eigen::VectorXd::Unit(knots, k), &basis(r * Columns, k));
    }
  }
  if (basis.cols() > knots)
  {
    basis.col(knots) = Eigen::Map<const Eigen::VectorXf>(image.data(), basis.rows()).cast<double>();
  }
  return basis;
}

/** The minimum by reweighted least squares with full matrices. */
struct DenseFit
{
  double          cost;
  double          gain;
  Eigen::VectorXd residuals; ///< in the X-ray's unit
  Eigen::VectorXd weights;   ///< Huber's times the pixels', over the squared scale
  Eigen::MatrixXd basis;
  Eigen::MatrixXd normal;
};

DenseFit
FitDensely(const RadiographView & target, const IntensityDifferenceParameters & p, const Image & image)
{
  const Eigen::Index    n = Columns * Rows;
  const Eigen::VectorXd w = target.weights.empty()
                              ? Eigen::VectorXd(Eigen::VectorXd::Ones(n))
                              : Eigen::Map<const Eigen::VectorXf>(target.weights.data(), n).cast<double>().eval();
  const Eigen::VectorXd t = Eigen::Map<const Eigen::VectorXf>(target.values.data(), n).cast<double>();
  const Eigen::VectorXd g = Eigen::Map<const Eigen::VectorXf>(image.data(), n).cast<double>();
  DenseFit              fit;
  fit.basis = Basis(p, image);
  const Eigen::Index unknowns = fit.basis.cols();
  const bool         fitsGain = p.gainDeviation > 0.0;
  Eigen::VectorXd    precision = Eigen::VectorXd::Constant(unknowns, std::pow(p.scale * p.backgroundDeviation, -2));
  Eigen::VectorXd    expected = Eigen::VectorXd::Zero(unknowns);
  if (fitsGain)
  {
    precision[unknowns - 1] = std::pow(p.gainDeviation, -2);
    expected[unknowns - 1] = 1.0;
  }
  const Eigen::VectorXd data = fitsGain ? t : Eigen::VectorXd(t - g);
  Eigen::VectorXd       x = expected;
  for (int iteration = 0; iteration < 500; ++iteration)
  {
    fit.residuals = data - fit.basis * x;
    fit.weights = w.array() / (p.scale * p.scale) * (p.huberThreshold * p.scale / fit.residuals.array().abs()).min(1.0);
    const Eigen::MatrixXd precisions = precision.asDiagonal();
    fit.normal = fit.basis.transpose() * fit.weights.asDiagonal() * fit.basis + precisions;
    const Eigen::VectorXd right =
      fit.basis.transpose() * fit.weights.cwiseProduct(data) + precision.cwiseProduct(expected);
    x = fit.normal.partialPivLu().solve(right);
  }
  fit.gain = fitsGain ? x[unknowns - 1] : 1.0;
  double sum = 0.5 * precision.dot((x - expected).cwiseAbs2());
  for (Eigen::Index i = 0; i < n; ++i)
  {
    const double z = std::abs(fit.residuals[i] / p.scale);
    sum += w[i] * (z <= p.huberThreshold ? 0.5 * z * z : p.huberThreshold * (z - 0.5 * p.huberThreshold));
  }
  fit.cost = sum / w.sum();
  return fit;
}

/** With and without background and gain. */
class IntensityDifferenceFits : public testing::TestWithParam<IntensityDifferenceParameters>
{
};

INSTANTIATE_TEST_SUITE_P(
  All,
  IntensityDifferenceFits,
  testing::Values(Parameters(0.0, 0.0), Parameters(13.0, 0.0), Parameters(0.0, 0.2), Parameters(13.0, 0.2)));

/** Weights from 0.5 to 1 and a hole. */
void
Weigh(RadiographView & target)
{
  for (int i = 0; i < Columns * Rows; ++i)
  {
    const bool hole = i % Columns > 25 && i % Columns < 33 && i / Columns > 8 && i / Columns < 17;
    target.weights.push_back(hole ? 0.0f : 0.5f + 0.5f * static_cast<float>(i % 7) / 6.0f);
  }
}

TEST_P(IntensityDifferenceFits, AgreesWithDenseAlgebra)
{
  RadiographView target = Target(Waves(1));
  Weigh(target);
  Image                     image = Waves(2);
  std::vector<Image>        derivatives{ Waves(3), Waves(4), Waves(5) };
  const IntensityDifference metric(target, GetParam());
  const MetricValue         value =
    metric.EvaluateDerivatives({ image.data(), derivatives[0].data(), derivatives[1].data(), derivatives[2].data() });
  const DenseFit fit = FitDensely(target, GetParam(), image);
  EXPECT_NEAR(value.cost, fit.cost, 1e-9 * fit.cost);
  EXPECT_NEAR(metric.GetGain(image.data()), fit.gain, 1e-6);
  const Image residuals = metric.Residuals(image.data());
  for (std::size_t i = 0; i < residuals.size(); ++i)
  {
    const double expected = target.weights[i] > 0.0f ? fit.residuals[static_cast<Eigen::Index>(i)] : 0.0;
    ASSERT_NEAR(residuals[i], expected, 1e-5) << i;
  }
  Eigen::MatrixXd jacobian(Columns * Rows, 3);
  for (Eigen::Index k = 0; k < 3; ++k)
  {
    jacobian.col(k) =
      fit.gain *
      Eigen::Map<const Eigen::VectorXf>(derivatives[static_cast<std::size_t>(k)].data(), Columns * Rows).cast<double>();
  }
  const double          total = std::accumulate(target.weights.begin(), target.weights.end(), 0.0);
  const Eigen::MatrixXd across = fit.basis.transpose() * fit.weights.asDiagonal() * jacobian;
  Eigen::MatrixXd       hessian = jacobian.transpose() * fit.weights.asDiagonal() * jacobian;
  if (across.rows() > 0)
  {
    hessian -= across.transpose() * fit.normal.partialPivLu().solve(across);
  }
  hessian /= total;
  EXPECT_LT((value.hessian - hessian).norm(), 1e-5 * hessian.norm());
  const Eigen::VectorXd gradient = -jacobian.transpose() * fit.weights.cwiseProduct(fit.residuals) / total;
  EXPECT_LT((value.gradient - gradient).norm(), 1e-5 * gradient.norm());
}

TEST_P(IntensityDifferenceFits, GradientAgreesWithDifferences)
{
  const IntensityDifference metric(Target(Waves(1)), GetParam());
  const Image               image = Waves(2);
  std::vector<Image>        images{ image, Waves(3), Waves(4), Waves(1) };
  const MetricValue         value = metric.EvaluateDerivatives(PointersTo(images));
  EXPECT_DOUBLE_EQ(value.cost, metric.Evaluate(image.data()));
  for (int k = 0; k < 3; ++k)
  {
    const double difference = CentralDifference(metric, image, images[static_cast<std::size_t>(k) + 1], 1e-3);
    EXPECT_NEAR(value.gradient[k], difference, 1e-4 * value.gradient.norm());
  }
  ASSERT_EQ(value.shares.cols(), 3 * 2);
  EXPECT_LT((value.shares.rowwise().sum() - value.gradient).norm(), 1e-10 * value.gradient.norm());
}

TEST_P(IntensityDifferenceFits, HessianIsPositiveSemidefiniteForDependentDerivatives)
{
  const IntensityDifference metric(Target(Waves(1)), GetParam());
  std::vector<Image>        images{ Waves(2), Waves(3), Waves(4), Waves(3), Image(Columns * Rows, 1.0f) };
  const MetricValue         value = metric.EvaluateDerivatives(PointersTo(images));
  const auto                eigen = EigenOf<Eigen::Dynamic>(value.hessian).values;
  EXPECT_GT(eigen.minCoeff(), -1e-6 * eigen.maxCoeff());
}

TEST_P(IntensityDifferenceFits, PixelsWithoutWeightDoNotCount)
{
  RadiographView target = Target(Waves(1));
  Weigh(target);
  std::vector<Image> images{ Waves(2), Waves(3), Waves(4) };
  const MetricValue  value = IntensityDifference(target, GetParam()).EvaluateDerivatives(PointersTo(images));
  for (std::size_t i = 0; i < target.weights.size(); ++i)
  {
    if (target.weights[i] == 0.0f)
    {
      target.values[i] = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : 1e30f;
      for (auto & image : images)
      {
        image[i] = target.values[i];
      }
    }
  }
  const MetricValue other = IntensityDifference(target, GetParam()).EvaluateDerivatives(PointersTo(images));
  EXPECT_EQ(value.cost, other.cost);
  EXPECT_EQ(value.gradient, other.gradient);
  EXPECT_EQ(value.hessian, other.hessian);
}

TEST(IntensityDifference, HessianIsThatOfTheCostWithinTheThreshold)
{
  IntensityDifferenceParameters parameters = Parameters(16.0, 0.0);
  parameters.huberThreshold = std::numeric_limits<double>::infinity();
  const IntensityDifference metric(Target(Waves(1)), parameters);
  std::vector<Image>        images{ Waves(2), Waves(3) };
  const MetricValue         value = metric.EvaluateDerivatives(PointersTo(images));
  Image                     moved = images[0];
  for (std::size_t i = 0; i < moved.size(); ++i)
  {
    moved[i] += images[1][i];
  }
  const double expected = value.cost + value.gradient[0] + 0.5 * value.hessian(0, 0);
  EXPECT_NEAR(metric.Evaluate(moved.data()), expected, 1e-5 * expected);
}

TEST(IntensityDifference, ASmoothBackgroundChangesNothing)
{
  IntensityDifferenceParameters parameters = Parameters(16.0, 0.0);
  parameters.backgroundDeviation = 1e6;
  RadiographView         target = Target(Waves(1));
  std::vector<Image>     images{ Waves(2), Waves(3) };
  const MetricValue      value = IntensityDifference(target, parameters).EvaluateDerivatives(PointersTo(images));
  const BackgroundSpline spline({ { Columns, Rows } }, 16.0);
  Eigen::VectorXd        coefficients(spline.GetNumberOfCoefficients());
  for (Eigen::Index k = 0; k < coefficients.size(); ++k)
  {
    coefficients[k] = 3.0 + std::sin(2.0 * static_cast<double>(k));
  }
  for (int r = 0; r < Rows; ++r)
  {
    std::array<double, Columns> row;
    spline.Evaluate(r, coefficients, row.data());
    for (std::size_t c = 0; c < row.size(); ++c)
    {
      target.values[static_cast<std::size_t>(r) * Columns + c] += static_cast<float>(row[c]);
    }
  }
  const IntensityDifference metric(target, parameters);
  const MetricValue         other = metric.EvaluateDerivatives(PointersTo(images));
  EXPECT_NEAR(other.cost, value.cost, 1e-6 * value.cost);
  EXPECT_NEAR(other.gradient[0], value.gradient[0], 1e-5 * std::abs(value.gradient[0]));
  EXPECT_NEAR(other.hessian(0, 0), value.hessian(0, 0), 1e-5 * value.hessian(0, 0));
}

TEST(IntensityDifference, FindsTheGainAndTheNoise)
{
  const Image                   image = Waves(1);
  IntensityDifferenceParameters parameters = Parameters(0.0, 0.5);
  const IntensityDifference     metric(Target(image, 0.8, 0.03), parameters);
  EXPECT_NEAR(metric.GetGain(image.data()), 0.8, 0.005);
  EXPECT_NEAR(metric.EstimateScale(image.data()), 0.03, 0.002);
  parameters.gainDeviation = 0.0;
  EXPECT_EQ(IntensityDifference(Target(image, 0.8), parameters).GetGain(image.data()), 1.0);
  EXPECT_NEAR(IntensityDifference(Target(image), parameters).Evaluate(image.data()), 0.5 * 0.05 * 0.05 / 0.04, 2e-3);
}

/** How far along its derivative, at 0 the truth, the radiograph goes to the least cost. */
double
StepToMinimum(const RadiographView & target, const IntensityDifferenceParameters & parameters)
{
  const IntensityDifference metric(target, parameters);
  std::vector<Image>        images{ Waves(1), Waves(3) };
  double                    step = 0.0;
  for (int iteration = 0; iteration < 30; ++iteration)
  {
    const MetricValue value = metric.EvaluateDerivatives(PointersTo(images));
    const double      change = -value.gradient[0] / value.hessian(0, 0);
    step += change;
    for (std::size_t i = 0; i < images[0].size(); ++i)
    {
      images[0][i] += static_cast<float>(change) * images[1][i];
    }
  }
  return step;
}

TEST(IntensityDifference, OutliersHardlyMoveTheMinimum)
{
  IntensityDifferenceParameters parameters = Parameters(16.0, 0.0);
  parameters.scale = 0.05;
  RadiographView target = Target(Waves(1));
  const Image    derivative = Waves(3);
  int            outliers = 0;
  for (std::size_t i = 5; i < derivative.size() && outliers < 20; i += 17)
  {
    if (derivative[i] > 0.5f)
    {
      target.values[i] += 100.0f;
      ++outliers;
    }
  }
  ASSERT_EQ(outliers, 20);
  EXPECT_LT(std::abs(StepToMinimum(target, parameters)), 0.01);
  parameters.huberThreshold = std::numeric_limits<double>::infinity();
  EXPECT_GT(std::abs(StepToMinimum(target, parameters)), 0.5);
}

TEST(IntensityDifference, RefusesWhatTellsNothing)
{
  RadiographView target = Target(Waves(1));
  EXPECT_NO_THROW(IntensityDifference{ target });
  const auto refuses = [](const RadiographView & view, const IntensityDifferenceParameters & parameters) {
    EXPECT_THROW(IntensityDifference(view, parameters), std::invalid_argument);
  };
  for (double wrong : { 0.0, -1.0, std::numeric_limits<double>::quiet_NaN() })
  {
    IntensityDifferenceParameters p[5];
    p[0].scale = wrong;
    p[1].huberThreshold = wrong;
    p[2].backgroundDeviation = wrong;
    p[3].knotSpacing = wrong - 0.5;
    p[4].gainDeviation = wrong - 0.5;
    for (const auto & parameters : p)
    {
      refuses(target, parameters);
    }
  }
  target.values[500] = std::numeric_limits<float>::quiet_NaN();
  refuses(target, {});
  target.weights.assign(target.values.size(), 0.0f);
  refuses(target, {});
  target = Target(Waves(1));
  target.values.pop_back();
  refuses(target, {});
}
} // namespace IntensityDifferenceTests
