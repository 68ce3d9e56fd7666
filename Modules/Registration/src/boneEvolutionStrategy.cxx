/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneEvolutionStrategy.h"

#include "bonePrincipalModes.h"
#include "boneSymmetricEigen.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace bone
{
EvolutionStrategy::EvolutionStrategy(const Eigen::VectorXd & mean,
                                     double                  deviation,
                                     Eigen::Index            population,
                                     std::uint64_t           seed)
  : m_Mean(mean)
  , m_Sigma(deviation)
  , m_Seed(seed)
  , m_Weights(population / 2)
  , m_Axes(Eigen::MatrixXd::Identity(mean.size(), mean.size()))
  , m_Lengths(Eigen::VectorXd::Ones(mean.size()))
  , m_Covariance(Eigen::MatrixXd::Identity(mean.size(), mean.size()))
  , m_PathOfSigma(Eigen::VectorXd::Zero(mean.size()))
  , m_PathOfCovariance(Eigen::VectorXd::Zero(mean.size()))
  , m_Steps(mean.size(), population)
  , m_Candidates(mean.size(), population)
  , m_Penalties(population)
  , m_Best(mean)
  , m_BestCost(std::numeric_limits<double>::infinity())
{
  for (Eigen::Index i = 0; i < m_Weights.size(); ++i)
  {
    m_Weights[i] = std::log(0.5 * static_cast<double>(population + 1)) - std::log(static_cast<double>(i + 1));
  }
  m_Weights /= m_Weights.sum();
  m_Effective = 1.0 / m_Weights.squaredNorm();
}

const Eigen::MatrixXd &
EvolutionStrategy::Ask()
{
  const Eigen::Index n = m_Mean.size();
  const auto         normal =
    SampleCoefficients(n * m_Steps.cols(), m_Seed * 1000003 + static_cast<std::uint64_t>(m_Generation));
  m_Steps = m_Axes * m_Lengths.asDiagonal() * normal.reshaped(n, m_Steps.cols());
  const Eigen::MatrixXd wanted = (m_Sigma * m_Steps).colwise() + m_Mean;
  m_Candidates = wanted.cwiseMax(-1.0).cwiseMin(1.0);
  m_Penalties = (wanted - m_Candidates).colwise().squaredNorm();
  return m_Candidates;
}

void
EvolutionStrategy::Tell(const Eigen::VectorXd & costs)
{
  const auto            n = static_cast<double>(m_Mean.size());
  const Eigen::VectorXd penalised =
    (costs + m_Penalties).unaryExpr([](double x) { return std::isnan(x) ? std::numeric_limits<double>::max() : x; });
  std::vector<Eigen::Index> order(static_cast<std::size_t>(penalised.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(
    order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return penalised[a] < penalised[b]; });
  if (penalised[order[0]] < m_BestCost)
  {
    m_BestCost = penalised[order[0]];
    m_Best = m_Candidates.col(order[0]);
  }
  Eigen::VectorXd move = Eigen::VectorXd::Zero(m_Mean.size());
  for (Eigen::Index i = 0; i < m_Weights.size(); ++i)
  {
    move += m_Weights[i] * m_Steps.col(order[static_cast<std::size_t>(i)]);
  }
  m_Mean += m_Sigma * move;
  ++m_Generation;

  // The tutorial's rates.
  const double ofSigma = (m_Effective + 2.0) / (n + m_Effective + 5.0);
  const double damping = 1.0 + 2.0 * std::max(0.0, std::sqrt((m_Effective - 1.0) / (n + 1.0)) - 1.0) + ofSigma;
  const double ofPath = (4.0 + m_Effective / n) / (n + 4.0 + 2.0 * m_Effective / n);
  const double rankOne = 2.0 / ((n + 1.3) * (n + 1.3) + m_Effective);
  const double rankMany =
    std::min(1.0 - rankOne, 2.0 * (m_Effective - 2.0 + 1.0 / m_Effective) / ((n + 2.0) * (n + 2.0) + m_Effective));
  const double expected = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)); // length of a normal vector

  const Eigen::VectorXd whitened = m_Axes * m_Lengths.cwiseInverse().asDiagonal() * (m_Axes.transpose() * move);
  m_PathOfSigma = (1.0 - ofSigma) * m_PathOfSigma + std::sqrt(ofSigma * (2.0 - ofSigma) * m_Effective) * whitened;
  const double settled = std::sqrt(1.0 - std::pow(1.0 - ofSigma, 2.0 * m_Generation));
  const bool   straight = m_PathOfSigma.norm() / settled < (1.4 + 2.0 / (n + 1.0)) * expected;
  m_PathOfCovariance *= 1.0 - ofPath;
  if (straight)
  {
    m_PathOfCovariance += std::sqrt(ofPath * (2.0 - ofPath) * m_Effective) * move;
  }
  const double lost = straight ? 0.0 : rankOne * ofPath * (2.0 - ofPath);
  m_Covariance =
    (1.0 - rankOne - rankMany + lost) * m_Covariance + rankOne * m_PathOfCovariance * m_PathOfCovariance.transpose();
  for (Eigen::Index i = 0; i < m_Weights.size(); ++i)
  {
    const auto step = m_Steps.col(order[static_cast<std::size_t>(i)]);
    m_Covariance += rankMany * m_Weights[i] * step * step.transpose();
  }
  m_Sigma *= std::exp(ofSigma / damping * (m_PathOfSigma.norm() / expected - 1.0));
  const SymmetricEigen eigen = EigenOf<Eigen::Dynamic>(m_Covariance);
  m_Axes = eigen.vectors;
  m_Lengths = eigen.values.cwiseMax(1e-30).cwiseSqrt();
}

bool
EvolutionStrategy::IsConverged(double deviation) const
{
  return m_Sigma * m_Lengths.maxCoeff() < deviation;
}
} // namespace bone
