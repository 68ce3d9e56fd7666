/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneIntensityDifference.h"

#include "boneBackgroundSpline.h"
#include "boneMetricPixels.h"
#include "boneSparseCholesky.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace bone
{
namespace
{
/** The second derivative of the loss, or what stands for it. */
enum class Curvature
{
  Square,     ///< of least squares
  Newton,     ///< of Huber's loss
  Reweighted, ///< that of the square that touches Huber's loss from above
};

/** Factorises the equations of background and gain, a band and a last row for the gain. */
bool
Factorize(SparseCholesky & solver, const Eigen::MatrixXd & lower)
{
  std::vector<SparseEntry> entries;
  for (Eigen::Index column = 0; column < lower.cols(); ++column)
  {
    for (Eigen::Index row = column; row < lower.rows(); ++row)
    {
      if (row == column || lower(row, column) != 0.0)
      {
        entries.push_back({ row, column, lower(row, column) });
      }
    }
  }
  return solver.Factorize(lower.rows(), entries);
}

void
Check(const char * name, double value, double least, double most, const char * range)
{
  if (!(value >= least && value <= most))
  {
    throw std::invalid_argument("the " + std::string(name) + " is " + std::to_string(value) + ", and must be " + range);
  }
}

void
Check(const IntensityDifferenceParameters & p)
{
  constexpr double tiny = std::numeric_limits<double>::min();
  constexpr double huge = std::numeric_limits<double>::max();
  Check("scale", p.scale, tiny, huge, "positive and finite");
  Check("Huber threshold", p.huberThreshold, tiny, std::numeric_limits<double>::infinity(), "positive");
  Check("prior deviation of the background", p.backgroundDeviation, tiny, huge, "positive and finite");
  Check("prior deviation of the gain", p.gainDeviation, 0.0, huge, "0 or more and finite");
  Check("spacing of the background's knots", p.knotSpacing, 0.0, huge, "0, or 4 or more and finite");
  if (p.knotSpacing > 0.0)
  {
    Check("spacing of the background's knots", p.knotSpacing, 4.0, huge, "0, or 4 or more and finite");
  }
}
} // namespace

struct IntensityDifference::Data
{
  IntensityDifferenceParameters parameters;
  std::array<int, 2>            whole; ///< size of the images
  PixelBox                      box;   ///< of the pixels that count, to which all else is cut
  std::array<int, 2>            size;
  BackgroundSpline              background;
  std::vector<float>            weights;
  std::vector<float>            values; ///< 0 where the weight is
  double                        totalWeight{ 0.0 };
  Eigen::VectorXd               expected;  ///< prior means of the unknowns: the background's coefficients, the gain
  Eigen::VectorXd               precision; ///< inverse prior variances

  Data(const RadiographView & target, const IntensityDifferenceParameters & p)
    : Data(target, p, CountedWeights(target, 0))
  {}

  Data(const RadiographView & target, const IntensityDifferenceParameters & p, const std::vector<float> & counted)
    : parameters(p)
    , whole(target.view.size)
    , box(BoxOf({ counted.data() }, whole))
    , size{ box.Columns(), box.Rows() }
    , background(size, p.knotSpacing)
    , weights(this->Cut(counted.data()))
    , values(this->Counted(target.values.data()))
  {
    for (float w : weights)
    {
      totalWeight += w;
    }
    const Eigen::Index knots = background.GetNumberOfCoefficients();
    const Eigen::Index unknowns = knots + (this->FitsGain() ? 1 : 0);
    expected = Eigen::VectorXd::Zero(unknowns);
    precision = Eigen::VectorXd::Constant(unknowns, std::pow(p.scale * p.backgroundDeviation, -2));
    if (this->FitsGain())
    {
      expected[knots] = 1.0;
      precision[knots] = std::pow(p.gainDeviation, -2);
    }
  }

  bool
  FitsGain() const
  {
    return parameters.gainDeviation > 0.0;
  }
  bool
  FitsBackground() const
  {
    return parameters.knotSpacing > 0.0;
  }
  double
  Gain(const Eigen::VectorXd & unknowns) const
  {
    return this->FitsGain() ? unknowns[unknowns.size() - 1] : 1.0;
  }
  std::size_t
  RowStart(int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(size[0]);
  }

  /** Where a row of the box starts in a whole image. */
  std::size_t
  WholeRowStart(int row) const
  {
    return static_cast<std::size_t>(box.first[1] + row) * static_cast<std::size_t>(whole[0]) +
           static_cast<std::size_t>(box.first[0]);
  }

  std::vector<float>
  Cut(const float * image) const
  {
    std::vector<float> cut;
    for (int r = 0; r < size[1]; ++r)
    {
      cut.insert(cut.end(), image + this->WholeRowStart(r), image + this->WholeRowStart(r) + size[0]);
    }
    return cut;
  }
  std::vector<float>
  Counted(const float * image) const
  {
    std::vector<float> counted = this->Cut(image);
    std::transform(weights.begin(), weights.end(), counted.begin(), counted.begin(), [](float w, float x) {
      return w > 0.0f ? x : 0.0f;
    });
    return counted;
  }

  /** Radiograph, unknowns and residuals at the minimum over the unknowns, or on the way there. */
  struct Fit
  {
    std::vector<float>  image; ///< 0 where the weight is
    Eigen::VectorXd     unknowns;
    std::vector<double> residuals; ///< in scales, 0 where the weight is
    double              objective{ 0.0 };
  };

  /** Residuals and objective of other unknowns. */
  void
  Move(Fit & fit, const Eigen::VectorXd & unknowns) const
  {
    fit.unknowns = unknowns;
    fit.residuals.resize(weights.size());
    fit.objective = 0.5 * precision.dot((unknowns - expected).cwiseAbs2());
    const double        gain = this->Gain(unknowns);
    const double        threshold = parameters.huberThreshold;
    const double        inverse = 1.0 / parameters.scale;
    std::vector<double> smooth(static_cast<std::size_t>(size[0]), 0.0);
    for (int r = 0; r < size[1]; ++r)
    {
      if (this->FitsBackground())
      {
        background.Evaluate(r, unknowns, smooth.data());
      }
      double sum = 0.0;
      for (std::size_t c = 0, i = this->RowStart(r); c < smooth.size(); ++c, ++i)
      {
        const double z = weights[i] > 0.0f ? inverse * (values[i] - gain * fit.image[i] - smooth[c]) : 0.0;
        const double psi = std::clamp(z, -threshold, threshold);
        fit.residuals[i] = z;
        sum += weights[i] * psi * (z - 0.5 * psi);
      }
      fit.objective += sum;
    }
  }

  /** Weight of a pixel of residual z (in scales) in the equations. */
  double
  Weigh(double z, Curvature curvature) const
  {
    const double threshold = parameters.huberThreshold;
    if (curvature == Curvature::Square || std::abs(z) <= threshold)
    {
      return 1.0;
    }
    return curvature == Curvature::Newton ? 0.0 : threshold / std::abs(z);
  }

  /** The second derivatives of the objective by the unknowns (lower triangle) and its negative first ones. */
  void
  Differentiate(const Fit & fit, Curvature curvature, Eigen::MatrixXd & second, Eigen::VectorXd & descent) const
  {
    const Eigen::Index n = expected.size();
    const Eigen::Index gain = n - 1;
    const double       inverse = 1.0 / parameters.scale;
    second = precision.asDiagonal();
    descent = precision.cwiseProduct(expected - fit.unknowns);
    Eigen::VectorXd     withGain = Eigen::VectorXd::Zero(n);
    std::vector<double> h(static_cast<std::size_t>(size[0]));
    std::vector<double> psi(h.size());
    for (int r = 0; r < size[1]; ++r)
    {
      for (std::size_t c = 0, i = this->RowStart(r); c < h.size(); ++c, ++i)
      {
        const double z = fit.residuals[i];
        h[c] = inverse * inverse * weights[i] * this->Weigh(z, curvature);
        psi[c] = inverse * weights[i] * std::clamp(z, -parameters.huberThreshold, parameters.huberThreshold);
      }
      if (this->FitsBackground())
      {
        background.AddNormalMatrix(r, h.data(), second);
        background.AddProducts(r, psi.data(), descent);
      }
      if (this->FitsGain())
      {
        for (std::size_t c = 0, i = this->RowStart(r); c < h.size(); ++c, ++i)
        {
          descent[gain] += psi[c] * fit.image[i];
          h[c] *= fit.image[i];
          withGain[gain] += h[c] * fit.image[i];
        }
        if (this->FitsBackground())
        {
          background.AddProducts(r, h.data(), withGain);
        }
      }
    }
    if (this->FitsGain())
    {
      second.row(gain) += withGain.transpose();
    }
  }

  Fit
  Minimize(const float * image) const
  {
    Fit fit;
    fit.image = this->Counted(image);
    this->Move(fit, expected);
    Eigen::MatrixXd second;
    Eigen::VectorXd descent;
    SparseCholesky  solver;
    Curvature       curvature = Curvature::Square;
    for (int iteration = 0; iteration < 100 && expected.size() > 0; ++iteration)
    {
      this->Differentiate(fit, curvature, second, descent);
      const Eigen::VectorXd step = Factorize(solver, second) ? solver.Solve(descent) : 0.0 * descent;
      if (!(descent.dot(step) > 1e-13 * (fit.objective + 1e-6 * totalWeight)))
      {
        break;
      }
      Fit next;
      next.image.swap(fit.image);
      this->Move(next, fit.unknowns + step);
      const bool better = next.objective < fit.objective;
      if (better)
      {
        std::swap(fit, next);
      }
      else
      {
        fit.image.swap(next.image);
        if (curvature == Curvature::Reweighted)
        {
          break; // This step lowers the objective, but for rounding.
        }
      }
      curvature = better ? Curvature::Newton : Curvature::Reweighted;
    }
    return fit;
  }

  /** Square roots of the pixels' weights times Huber's. */
  std::vector<float>
  Roots(const Fit & fit) const
  {
    std::vector<float> roots(weights.size());
    std::transform(weights.begin(), weights.end(), fit.residuals.begin(), roots.begin(), [this](float w, double z) {
      return static_cast<float>(std::sqrt(w * this->Weigh(z, Curvature::Reweighted)));
    });
    return roots;
  }

  /** The unknowns that fit the residuals' derivatives best, #unknowns by #parameters. */
  Eigen::MatrixXd
  Regress(const Fit & fit, const std::vector<float> & roots, const std::vector<float *> & images) const
  {
    const Eigen::Index n = expected.size();
    Eigen::MatrixXd    taken = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(images.size()) - 1);
    if (n == 0)
    {
      return taken;
    }
    const double        factor = this->Gain(fit.unknowns) / (parameters.scale * parameters.scale);
    std::vector<double> products(static_cast<std::size_t>(size[0]));
    for (Eigen::Index k = 0; k < taken.cols(); ++k)
    {
      for (int r = 0; r < size[1]; ++r)
      {
        const float * derivative = images[static_cast<std::size_t>(k) + 1] + this->WholeRowStart(r);
        double        withGain = 0.0;
        for (std::size_t c = 0, i = this->RowStart(r); c < products.size(); ++c, ++i)
        {
          const double root = roots[i];
          products[c] = root > 0.0 ? factor * root * root * derivative[c] : 0.0;
          withGain += products[c] * fit.image[i];
        }
        if (this->FitsBackground())
        {
          background.AddProducts(r, products.data(), taken.col(k));
        }
        if (this->FitsGain())
        {
          taken(n - 1, k) += withGain;
        }
      }
    }
    Eigen::MatrixXd second;
    Eigen::VectorXd descent;
    this->Differentiate(fit, Curvature::Reweighted, second, descent);
    SparseCholesky solver;
    Factorize(solver, second);
    return solver.Solve(taken);
  }

  /** A row of the derivatives of the residuals in scales, less what the unknowns take up, times the roots: #columns by
   * #parameters. */
  void
  Project(int                          row,
          const Fit &                  fit,
          const std::vector<float> &   roots,
          const Eigen::MatrixXd &      taken,
          const std::vector<float *> & images,
          Eigen::MatrixXf &            part) const
  {
    const double        gain = this->Gain(fit.unknowns);
    std::vector<double> smooth(static_cast<std::size_t>(size[0]), 0.0);
    for (Eigen::Index k = 0; k < part.cols(); ++k)
    {
      const float * derivative = images[static_cast<std::size_t>(k) + 1] + this->WholeRowStart(row);
      if (this->FitsBackground())
      {
        background.Evaluate(row, taken.col(k), smooth.data());
      }
      const double ofGain = this->FitsGain() ? taken(taken.rows() - 1, k) : 0.0;
      for (std::size_t c = 0, i = this->RowStart(row); c < smooth.size(); ++c, ++i)
      {
        const double rest = gain * derivative[c] - smooth[c] - ofGain * fit.image[i];
        part(static_cast<Eigen::Index>(c), k) =
          roots[i] > 0.0f ? static_cast<float>(roots[i] / parameters.scale * rest) : 0.0f;
      }
    }
  }
};

IntensityDifference::~IntensityDifference() = default;

IntensityDifference::IntensityDifference(const RadiographView &                target,
                                         const IntensityDifferenceParameters & parameters)
{
  Check(parameters);
  m_Data = std::make_unique<const Data>(target, parameters);
  if (!std::all_of(m_Data->values.begin(), m_Data->values.end(), [](float t) { return std::isfinite(t); }))
  {
    throw std::invalid_argument("the X-ray is not finite where its pixels count");
  }
}

double
IntensityDifference::Evaluate(const float * image) const
{
  return m_Data->Minimize(image).objective / m_Data->totalWeight;
}

MetricValue
IntensityDifference::EvaluateDerivatives(const std::vector<float *> & images) const
{
  const Data &       data = *m_Data;
  const auto         fit = data.Minimize(images[0]);
  const auto         m = static_cast<Eigen::Index>(images.size()) - 1;
  const Eigen::Index columns = data.size[0];
  const ShareBlocks  blocks(data.size);

  const std::vector<float> roots = data.Roots(fit);
  const Eigen::MatrixXd    taken = data.Regress(fit, roots, images);

  MetricValue value;
  value.cost = fit.objective / data.totalWeight;
  value.blocksInRow = blocks.columns;
  value.shares = Eigen::MatrixXd::Zero(m, blocks.GetNumberOfBlocks());
  Eigen::VectorXd blockWeights = Eigen::VectorXd::Zero(blocks.GetNumberOfBlocks());
  GramSum         gram(m);
  Eigen::MatrixXf part(columns, m);
  Eigen::VectorXf residuals(columns);
  for (int r = 0; r < data.size[1]; ++r)
  {
    for (Eigen::Index c = 0; c < columns; ++c)
    {
      const std::size_t i = data.RowStart(r) + static_cast<std::size_t>(c);
      residuals[c] = static_cast<float>(roots[i] * fit.residuals[i]);
      blockWeights[blocks.BlockOf(static_cast<int>(c), r)] += data.weights[i];
    }
    data.Project(r, fit, roots, taken, images, part);
    for (int b = 0; b < blocks.columns; ++b)
    {
      const Eigen::Index first = static_cast<Eigen::Index>(b) * ShareBlocks::side;
      const Eigen::Index count = std::min<Eigen::Index>(ShareBlocks::side, columns - first);
      value.shares.col(blocks.BlockOf(static_cast<int>(first), r)) -=
        (part.middleRows(first, count).transpose() * residuals.segment(first, count)).cast<double>();
    }
    gram.Add(part, columns);
  }
  const Eigen::VectorXd ofPriors = taken.transpose() * data.precision.cwiseProduct(fit.unknowns - data.expected);
  value.shares -= ofPriors * (blockWeights / data.totalWeight).transpose();
  value.shares /= data.totalWeight;
  value.gradient = value.shares.rowwise().sum();
  value.hessian = gram.Get() + taken.transpose() * data.precision.asDiagonal() * taken;
  value.hessian /= data.totalWeight;
  return value;
}

std::vector<float>
IntensityDifference::Residuals(const float * image) const
{
  const auto         fit = m_Data->Minimize(image);
  std::vector<float> residuals(static_cast<std::size_t>(m_Data->whole[0]) * static_cast<std::size_t>(m_Data->whole[1]));
  for (int r = 0; r < m_Data->size[1]; ++r)
  {
    for (std::size_t c = 0; c < static_cast<std::size_t>(m_Data->size[0]); ++c)
    {
      residuals[m_Data->WholeRowStart(r) + c] =
        static_cast<float>(m_Data->parameters.scale * fit.residuals[m_Data->RowStart(r) + c]);
    }
  }
  return residuals;
}

double
IntensityDifference::EstimateScale(const float * image) const
{
  const auto          fit = m_Data->Minimize(image);
  std::vector<double> magnitudes;
  for (std::size_t i = 0; i < fit.residuals.size(); ++i)
  {
    if (m_Data->weights[i] > 0.0f)
    {
      magnitudes.push_back(std::abs(fit.residuals[i]));
    }
  }
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return 1.4826 * m_Data->parameters.scale * *middle;
}

double
IntensityDifference::GetGain(const float * image) const
{
  return m_Data->Gain(m_Data->Minimize(image).unknowns);
}
} // namespace bone
