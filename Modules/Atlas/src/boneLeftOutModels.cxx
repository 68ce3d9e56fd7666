/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLeftOutModels.h"

#include "boneSymmetricEigen.h"

#include <algorithm>

namespace bone
{
namespace
{
constexpr Eigen::Index Held = 256; // half of them are kept where there are more subjects: each costs an eigenproblem
} // namespace

LeftOutModels::LeftOutModels(Eigen::Index dimension, Eigen::Index count)
  : m_All(dimension, count, static_cast<std::size_t>(Held * dimension) * sizeof(double), Held)
{}

void
LeftOutModels::Finish()
{
  m_All.Finish([](const Eigen::VectorXd & variances, double) { return variances.size(); });
}

Eigen::VectorXd
LeftOutModels::MeanWithout(const Eigen::VectorXd & y) const
{
  return m_All.GetMean() - (y - m_All.GetMean()) / static_cast<double>(m_All.GetCount() - 1);
}

void
LeftOutModels::Reconstruct(const Eigen::VectorXd &                                                  y,
                           const Eigen::VectorXd &                                                  x,
                           const std::vector<int> &                                                 modes,
                           const std::function<void(std::size_t m, const Eigen::VectorXd & near)> & visit) const
{
  const auto              n = static_cast<double>(m_All.GetCount());
  const Eigen::MatrixXd & basis = m_All.GetModes();
  const Eigen::VectorXd   own = basis.transpose() * (y - m_All.GetMean());
  Eigen::MatrixXd         squares = -n / (n - 1) * own * own.transpose();
  squares.diagonal() += (n - 1) * m_All.GetVariances();
  const SymmetricEigen  others = EigenOf(squares);
  const Eigen::MatrixXd directions = others.vectors.rowwise().reverse();
  const Eigen::Index    real = CountAboveRounding(others.values.reverse());
  const Eigen::VectorXd mean = this->MeanWithout(y);
  const Eigen::VectorXd coefficients = directions.transpose() * (basis.transpose() * (x - mean));
  for (std::size_t m = 0; m < modes.size(); ++m)
  {
    const Eigen::Index k = std::min<Eigen::Index>(modes[m], real);
    visit(m, mean + basis * (directions.leftCols(k) * coefficients.head(k)));
  }
}
} // namespace bone
