/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePrincipalModes.h"

#include "boneSymmetricEigen.h"

#include <Eigen/Cholesky>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>

#include <sstream>
#include <stdexcept>

namespace bone
{
namespace
{
void
Require(bool holds, const char * what, Eigen::Index got, Eigen::Index expected)
{
  if (!holds)
  {
    std::ostringstream text;
    text << what << ": " << got << " given, the model has " << expected << '.';
    throw std::invalid_argument(text.str());
  }
}
} // namespace

Eigen::VectorXd
PrincipalModes::Synthesize(const Eigen::VectorXd & coefficients) const
{
  const Eigen::Index k = coefficients.size();
  Require(k <= this->GetNumberOfModes(), "Too many coefficients", k, this->GetNumberOfModes());
  return mean + modes.leftCols(k) * (variances.head(k).cwiseSqrt().cwiseProduct(coefficients));
}

Eigen::VectorXd
PrincipalModes::Dual(Eigen::VectorXd y) const
{
  Require(y.size() == this->GetDimension(), "Vector of the wrong length", y.size(), this->GetDimension());
  if (block.size() > 0)
  {
    Eigen::Map<Eigen::MatrixXd> runs(y.data(), block.rows(), y.size() / block.rows());
    runs = (block * runs).eval();
  }
  if (weights.size() > 0)
  {
    y = y.cwiseProduct(weights);
  }
  return y;
}

Eigen::VectorXd
PrincipalModes::Project(const Eigen::VectorXd & y) const
{
  Require(y.size() == this->GetDimension(), "Vector of the wrong length", y.size(), this->GetDimension());
  return (modes.transpose() * this->Dual(y - mean)).cwiseQuotient(variances.cwiseSqrt());
}

PrincipalModes
PrincipalModes::Posterior(const std::vector<Eigen::Index> & entries, const Eigen::VectorXd & values, double noise) const
{
  const auto         observed = static_cast<Eigen::Index>(entries.size());
  const Eigen::Index k = this->GetNumberOfModes();
  Require(values.size() == observed, "Values do not match the entries", values.size(), observed);
  if (!(noise > 0))
  {
    throw std::invalid_argument("The noise of a posterior must be above 0.");
  }
  const Eigen::VectorXd deviation = variances.cwiseSqrt();
  Eigen::MatrixXd       q(observed, k);
  Eigen::VectorXd       residual(observed);
  for (Eigen::Index i = 0; i < observed; ++i)
  {
    Require(
      entries[i] >= 0 && entries[i] < this->GetDimension(), "Entry out of range", entries[i], this->GetDimension());
    q.row(i) = modes.row(entries[i]).cwiseProduct(deviation.transpose()) / noise;
    residual[i] = (values[i] - mean[entries[i]]) / noise;
  }
  const Eigen::MatrixXd             precision = Eigen::MatrixXd::Identity(k, k) + q.transpose() * q;
  const Eigen::LLT<Eigen::MatrixXd> factor(precision);
  const Eigen::VectorXd             b = factor.solve(q.transpose() * residual);
  const Eigen::MatrixXd             scale = deviation.asDiagonal();
  const Eigen::MatrixXd             half = factor.matrixL().solve(scale);
  const SymmetricEigen              eigen = EigenOf<Eigen::Dynamic>(half.transpose() * half);

  PrincipalModes posterior;
  posterior.mean = this->Synthesize(b);
  posterior.modes = modes * eigen.vectors.rowwise().reverse();
  posterior.variances = eigen.values.reverse().cwiseMax(0.0);
  posterior.weights = weights;
  posterior.block = block;
  posterior.totalVariance = posterior.variances.sum();
  return posterior;
}

Eigen::VectorXd
PrincipalModes::StandardDeviations() const
{
  return (modes.array().square().matrix() * variances).cwiseSqrt();
}

Eigen::VectorXd
ClampToBox(const Eigen::VectorXd & coefficients, double limit)
{
  if (!(limit >= 0))
  {
    throw std::invalid_argument("The limit of coefficients must not be negative.");
  }
  return coefficients.cwiseMin(limit).cwiseMax(-limit);
}

double
ChiRadius(Eigen::Index degreesOfFreedom, double probability)
{
  if (!(probability > 0 && probability < 1) || degreesOfFreedom < 1)
  {
    throw std::invalid_argument(
      "A ball of coefficients needs a probability between 0 and 1 and one coefficient or more.");
  }
  const boost::math::chi_squared distribution(static_cast<double>(degreesOfFreedom));
  return std::sqrt(boost::math::quantile(distribution, probability));
}

Eigen::VectorXd
ClampToBall(const Eigen::VectorXd & coefficients, double probability)
{
  const double radius = ChiRadius(coefficients.size(), probability);
  const double length = coefficients.norm();
  return length > radius ? Eigen::VectorXd(coefficients * (radius / length)) : coefficients;
}

Eigen::VectorXd
SampleCoefficients(Eigen::Index count, std::uint64_t seed)
{
  boost::random::mt19937_64                  generator(seed);
  boost::random::normal_distribution<double> normal;
  Eigen::VectorXd                            coefficients(count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    coefficients[i] = normal(generator);
  }
  return coefficients;
}
} // namespace bone
