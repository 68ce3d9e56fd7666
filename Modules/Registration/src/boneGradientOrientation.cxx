/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneGradientOrientation.h"

#include "boneMetricPixels.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
void
CheckPositive(const char * name, double value)
{
  if (!(value > 0.0 && std::isfinite(value)))
  {
    throw std::invalid_argument("the " + std::string(name) + " is " + std::to_string(value) +
                                ", and must be positive and finite");
  }
}

/** sigma, if it is one. */
double
CheckedSigma(double sigma)
{
  CheckPositive("Gaussian's standard deviation", sigma);
  return sigma;
}
} // namespace

struct GradientOrientation::Data
{
  /** An image's gradients and what becomes of them. */
  struct Orientation
  {
    GradientComponents  unit;       ///< the gradients g, then u = g / q
    std::vector<double> inverse;    ///< 1 / q of each pixel, q^2 = |g|^2 + e^2
    double              meanSquare; ///< weighted mean of |g|^2; 0 for a constant image
    double              norm;       ///< square root of the sum of w |u|^2
  };
  CountedGradient    gradient;
  std::array<int, 2> size;
  double             threshold;
  double             totalWeight{ 0.0 };
  Orientation        fixed;

  Data(const RadiographView & target, double sigma, double relativeThreshold)
    : gradient(target, sigma)
    , size(target.view.size)
    , threshold(relativeThreshold)
  {
    for (float w : gradient.GetWeights())
    {
      totalWeight += w;
    }
    fixed = this->Orient(target.values.data());
  }

  /** The weighted sum over pixels of a . b. */
  double
  Product(const GradientComponents & a, const GradientComponents & b) const
  {
    const auto & weights = gradient.GetWeights();
    double       sum = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i)
    {
      const double product = static_cast<double>(a[0][i]) * b[0][i] + static_cast<double>(a[1][i]) * b[1][i];
      sum += weights[i] * product;
    }
    return sum;
  }

  /** The weighted mean of the image's squared values. */
  double
  MeanSquare(const float * image) const
  {
    double sum = 0.0;
    for (float w : gradient.GetWeights())
    {
      sum += w > 0.0f ? static_cast<double>(w) * *image * *image : 0.0;
      ++image;
    }
    return sum / totalWeight;
  }

  Orientation
  Orient(const float * image) const
  {
    Orientation result;
    result.unit = gradient.Apply(image);
    result.meanSquare = this->Product(result.unit, result.unit) / totalWeight;
    if (result.meanSquare <= 1e-12 * this->MeanSquare(image))
    {
      result.meanSquare = 0.0; // The gradients are those of rounding.
    }
    result.inverse.assign(gradient.GetWeights().size(), 0.0);
    for (std::size_t i = 0; i < result.inverse.size() && result.meanSquare > 0.0; ++i)
    {
      const double x = result.unit[0][i];
      const double y = result.unit[1][i];
      result.inverse[i] = 1.0 / std::sqrt(x * x + y * y + threshold * threshold * result.meanSquare);
      result.unit[0][i] = static_cast<float>(x * result.inverse[i]);
      result.unit[1][i] = static_cast<float>(y * result.inverse[i]);
    }
    result.norm = std::sqrt(this->Product(result.unit, result.unit));
    return result;
  }

  /** The derivative of u, less its part along u, given that of the radiograph. */
  GradientComponents
  Differentiate(const Orientation & model, const float * derivative) const
  {
    const auto & weights = gradient.GetWeights();
    auto         change = gradient.Apply(derivative);
    // With u = g / q: du = dg / q - u dq / q, and q dq = g . dg + e de.
    double ofThreshold = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i)
    {
      if (weights[i] > 0.0f)
      {
        const double along =
          static_cast<double>(model.unit[0][i]) * change[0][i] + static_cast<double>(model.unit[1][i]) * change[1][i];
        ofThreshold += weights[i] * along / model.inverse[i];
      }
    }
    ofThreshold *= threshold * threshold / totalWeight;
    double along = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i)
    {
      const double p = model.inverse[i];
      const double u = model.unit[0][i];
      const double v = model.unit[1][i];
      const double x = p * change[0][i];
      const double y = p * change[1][i];
      const double stretch = u * x + v * y + p * p * ofThreshold;
      change[0][i] = static_cast<float>(x - u * stretch);
      change[1][i] = static_cast<float>(y - v * stretch);
      along += weights[i] * (u * change[0][i] + v * change[1][i]);
    }
    along /= model.norm * model.norm;
    for (int axis = 0; axis < 2; ++axis)
    {
      for (std::size_t i = 0; i < weights.size(); ++i)
      {
        change[axis][i] -= static_cast<float>(along * model.unit[axis][i]);
      }
    }
    return change;
  }

  /** What of the X-ray's u is not a multiple of the radiograph's. */
  GradientComponents
  Residuals(const Orientation & model) const
  {
    GradientComponents residuals = fixed.unit;
    const auto         factor =
      static_cast<float>(this->Product(fixed.unit, model.unit) / this->Product(model.unit, model.unit));
    for (int axis = 0; axis < 2; ++axis)
    {
      for (std::size_t i = 0; i < residuals[axis].size(); ++i)
      {
        residuals[axis][i] -= factor * model.unit[axis][i];
      }
    }
    return residuals;
  }

  /** The sums over blocks of w residual . change. */
  Eigen::VectorXd
  BlockProducts(const ShareBlocks &        blocks,
                const GradientComponents & residuals,
                const GradientComponents & change) const
  {
    const auto &    weights = gradient.GetWeights();
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(blocks.GetNumberOfBlocks());
    std::size_t     i = 0;
    for (int r = 0; r < size[1]; ++r)
    {
      for (int c = 0; c < size[0]; ++c, ++i)
      {
        const float product = residuals[0][i] * change[0][i] + residuals[1][i] * change[1][i];
        sums[blocks.BlockOf(c, r)] += weights[i] * product;
      }
    }
    return sums;
  }

  /** The weighted sums over pixels of the products of changes. */
  Eigen::MatrixXd
  Gram(const std::vector<GradientComponents> & changes) const
  {
    const auto &    weights = gradient.GetWeights();
    const auto      m = static_cast<Eigen::Index>(changes.size());
    GramSum         gram(m);
    Eigen::MatrixXf part(size[0], m);
    for (int r = 0; r < size[1]; ++r)
    {
      const std::size_t start = static_cast<std::size_t>(r) * static_cast<std::size_t>(size[0]);
      for (int axis = 0; axis < 2; ++axis)
      {
        for (Eigen::Index k = 0; k < m; ++k)
        {
          const float * change = &changes[static_cast<std::size_t>(k)][axis][start];
          for (Eigen::Index c = 0; c < size[0]; ++c)
          {
            part(c, k) = std::sqrt(weights[start + static_cast<std::size_t>(c)]) * change[c];
          }
        }
        gram.Add(part, size[0]);
      }
    }
    return gram.Get();
  }
};

GradientOrientation::~GradientOrientation() = default;

GradientOrientation::GradientOrientation(const RadiographView & target, double sigma, double threshold)
{
  CheckPositive("threshold of the gradients", threshold);
  m_Data = std::make_unique<const Data>(target, CheckedSigma(sigma), threshold);
  if (!(m_Data->fixed.meanSquare > 0.0 && std::isfinite(m_Data->fixed.norm)))
  {
    throw std::invalid_argument("the X-ray is constant or not finite where its pixels count");
  }
}

double
GradientOrientation::Evaluate(const float * image) const
{
  const Data::Orientation model = m_Data->Orient(image);
  if (model.meanSquare == 0.0)
  {
    return 1.0;
  }
  return 1.0 - m_Data->Product(m_Data->fixed.unit, model.unit) / (m_Data->fixed.norm * model.norm);
}

MetricValue
GradientOrientation::EvaluateDerivatives(const std::vector<float *> & images) const
{
  const Data &            data = *m_Data;
  const auto              m = static_cast<Eigen::Index>(images.size()) - 1;
  const Data::Orientation model = data.Orient(images[0]);
  const ShareBlocks       blocks(data.size);
  MetricValue             value;
  value.blocksInRow = blocks.columns;
  value.shares = Eigen::MatrixXd::Zero(m, blocks.GetNumberOfBlocks());
  value.gradient = Eigen::VectorXd::Zero(m);
  value.hessian = Eigen::MatrixXd::Zero(m, m);
  value.cost = 1.0;
  if (model.meanSquare == 0.0)
  {
    return value;
  }
  const double scale = 1.0 / (data.fixed.norm * model.norm);
  value.cost = 1.0 - scale * data.Product(data.fixed.unit, model.unit);
  const GradientComponents        residuals = data.Residuals(model);
  std::vector<GradientComponents> changes;
  for (Eigen::Index k = 0; k < m; ++k)
  {
    changes.push_back(data.Differentiate(model, images[static_cast<std::size_t>(k) + 1]));
    value.shares.row(k) = -scale * data.BlockProducts(blocks, residuals, changes.back());
  }
  value.gradient = value.shares.rowwise().sum();
  value.hessian = std::max(1.0 - value.cost, 0.1) / (model.norm * model.norm) * data.Gram(changes);
  return value;
}
} // namespace bone
