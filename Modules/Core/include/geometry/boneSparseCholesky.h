/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSparseCholesky_h
#define boneSparseCholesky_h

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace bone
{
/** One summand of an element of a sparse matrix: those of one place add up. What Eigen asks of a triplet. */
class SparseEntry
{
public:
  SparseEntry(Eigen::Index row, Eigen::Index column, double value)
    : m_Row(static_cast<int>(row))
    , m_Column(static_cast<int>(column))
    , m_Value(value)
  {}

  int
  row() const
  {
    return m_Row;
  }
  int
  col() const
  {
    return m_Column;
  }
  double
  value() const
  {
    return m_Value;
  }

private:
  int    m_Row;
  int    m_Column;
  double m_Value;
};

/** Solves a sparse, symmetric, positive definite system by Eigen's SimplicialLDLT, which is compiled here alone. Only
 * the lower triangle is read. */
class SparseCholesky
{
public:
  SparseCholesky();
  ~SparseCholesky();

  /** size by size, entries in any order. A further matrix with entries at the same places is factorised faster. False
   * when it has no factor. */
  bool
  Factorize(Eigen::Index size, const std::vector<SparseEntry> & entries);

  /** The solution for each column. */
  Eigen::MatrixXd
  Solve(const Eigen::MatrixXd & right) const;

private:
  struct Factor;
  std::unique_ptr<Factor> m_Factor;
};
} // namespace bone

#endif
