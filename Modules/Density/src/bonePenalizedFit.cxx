/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePenalizedFit.h"

#include <Eigen/Cholesky>

#include <cmath>
#include <stdexcept>

namespace bone
{
PenalizedFit::PenalizedFit(int degree, const std::vector<double> & penalties)
  : m_Degree(degree)
  , m_Scale(BernsteinCount(degree))
{
  if (penalties.size() != static_cast<std::size_t>(degree) + 1)
  {
    throw std::invalid_argument("A penalized fit needs a penalty for each degree.");
  }
  for (int k = 0, c = 0; k <= degree; ++k)
  {
    if (!(penalties[k] > 0 && std::isfinite(penalties[k])))
    {
      throw std::invalid_argument("A penalty must be above 0, not " + std::to_string(penalties[k]) + ".");
    }
    for (; c < BernsteinCount(k); ++c)
    {
      m_Scale[c] = 1 / std::sqrt(penalties[k]);
    }
  }
}

void
PenalizedFit::Solve(std::size_t         count,
                    const Barycentric * points,
                    const double *      values,
                    const double *      weights,
                    double              total,
                    double *            orthonormal) const
{
  const auto      number = static_cast<Eigen::Index>(count);
  Eigen::MatrixXd basis(m_Scale.size(), number); // scaled by weights and penalties
  Eigen::VectorXd right(number);
  for (Eigen::Index v = 0; v < number; ++v)
  {
    const double root = weights == nullptr ? 1.0 : std::sqrt(weights[v]);
    OrthonormalBasis(m_Degree, points[v], basis.col(v).data());
    basis.col(v).array() *= root * m_Scale;
    right[v] = root * values[v];
  }
  const bool         dual = number < m_Scale.size();
  const Eigen::Index unknowns = dual ? number : m_Scale.size();
  Eigen::MatrixXd    matrix = Eigen::MatrixXd::Identity(unknowns, unknowns) * total;
  if (dual)
  {
    matrix.noalias() += basis.transpose() * basis;
  }
  else
  {
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(basis);
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
  Eigen::Map<Eigen::VectorXd>                   result(orthonormal, m_Scale.size());
  if (dual)
  {
    result.noalias() = basis * factor.solve(right);
  }
  else
  {
    result.noalias() = factor.solve(basis * right);
  }
  result.array() *= m_Scale;
}
} // namespace bone
