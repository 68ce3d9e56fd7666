/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSparseCholesky.h"

#include <Eigen/SparseCholesky>

#include <algorithm>

namespace bone
{
struct SparseCholesky::Factor
{
  Eigen::SparseMatrix<double>                        matrix;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
};

SparseCholesky::SparseCholesky()
  : m_Factor(std::make_unique<Factor>())
{}

SparseCholesky::~SparseCholesky() = default;

bool
SparseCholesky::Factorize(Eigen::Index size, const std::vector<SparseEntry> & entries)
{
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const auto samePlaces = [](const Eigen::SparseMatrix<double> & a, const Eigen::SparseMatrix<double> & b) {
    return a.rows() == b.rows() && a.nonZeros() == b.nonZeros() &&
           std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
           std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
  };
  if (size == 0 || !samePlaces(matrix, m_Factor->matrix))
  {
    m_Factor->solver.analyzePattern(matrix);
  }
  m_Factor->solver.factorize(matrix);
  m_Factor->matrix.swap(matrix);
  return m_Factor->solver.info() == Eigen::Success;
}

Eigen::MatrixXd
SparseCholesky::Solve(const Eigen::MatrixXd & right) const
{
  return m_Factor->solver.solve(right);
}
} // namespace bone
