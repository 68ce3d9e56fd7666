/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVectorProduct.h"

#include <Eigen/Cholesky>

#include <stdexcept>

namespace bone
{
namespace
{
/** A column's runs of as many entries as the block has rows. */
Eigen::Map<Eigen::MatrixXd>
RunsOf(Eigen::Ref<Eigen::MatrixXd> vectors, Eigen::Index column, Eigen::Index rows)
{
  return { vectors.col(column).data(), rows, vectors.rows() / rows };
}
} // namespace

VectorProduct::VectorProduct(const Eigen::VectorXd & weights, const Eigen::MatrixXd & block)
  : m_Scale(weights.cwiseSqrt())
{
  if (block.size() > 0)
  {
    const Eigen::LLT<Eigen::MatrixXd> factor(block);
    if (factor.info() != Eigen::Success)
    {
      throw std::invalid_argument("The block of an inner product must be positive definite.");
    }
    m_Factor = factor.matrixU();
  }
}

void
VectorProduct::ToPlain(Eigen::Ref<Eigen::MatrixXd> vectors) const
{
  for (Eigen::Index k = 0; k < vectors.cols(); ++k)
  {
    if (m_Factor.size() > 0)
    {
      auto runs = RunsOf(vectors, k, m_Factor.rows());
      runs = (m_Factor * runs).eval();
    }
    if (m_Scale.size() > 0)
    {
      vectors.col(k).array() *= m_Scale.array();
    }
  }
}

void
VectorProduct::FromPlain(Eigen::Ref<Eigen::MatrixXd> vectors) const
{
  for (Eigen::Index k = 0; k < vectors.cols(); ++k)
  {
    if (m_Scale.size() > 0)
    {
      vectors.col(k).array() /= m_Scale.array();
    }
    if (m_Factor.size() > 0)
    {
      auto runs = RunsOf(vectors, k, m_Factor.rows());
      m_Factor.triangularView<Eigen::Upper>().solveInPlace(runs);
    }
  }
}
} // namespace bone
