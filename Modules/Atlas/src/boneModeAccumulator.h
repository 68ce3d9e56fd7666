/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneModeAccumulator_h
#define boneModeAccumulator_h

#include "boneExecution.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace bone
{
/** \class ModeAccumulator
 * \brief Principal modes of vectors that are given one after the other and not kept: sequential Karhunen-Loève basis
 * (A. Levey & M. Lindenbaum, doi:10.1109/83.855432) with the mean updated (D. A. Ross et al.,
 * doi:10.1007/s11263-007-0075-7).
 *
 * Holds a factor B and the vectors since it was made; when these fill the memory, both are replaced by a factor of at
 * most half as many columns: those of the largest eigenvalues of the matrix of inner products of them all. B B^T is the
 * sum of squares and products about the mean. Nothing is left out as long as all vectors fit into the memory, or span
 * no more than half of it; what is left out counts in the total variance. The inner product is the plain one. Time is
 * linear in the number of vectors. The result is the same for any number of threads. */
class ModeAccumulator
{
public:
  /** For `count` vectors of `dimension` entries, in `bytes` of memory: at least 32 vectors and at most `most` are held,
   * as time grows with their number, in each renewal of the factor by its cube. */
  ModeAccumulator(Eigen::Index      dimension,
                  Eigen::Index      count,
                  std::size_t       bytes,
                  Eigen::Index      most,
                  const Execution & execution = {});

  /** Begins with `count` vectors of known mean, modes (orthonormal columns), variances, and sum of variances. */
  void
  Start(Eigen::Index            count,
        const Eigen::VectorXd & mean,
        const Eigen::MatrixXd & modes,
        const Eigen::VectorXd & variances,
        double                  total);

  /** The place of the next vector, to be written before the next call. */
  Eigen::Ref<Eigen::VectorXd>
  Next();

  /** After the last vector: modes are made, the first `keep(variances, total)` of them, and the memory of the rest is
   * given back. Orthonormal to rounding. */
  template <typename TKeep>
  void
  Finish(const TKeep & keep)
  {
    this->Merge(m_Truncated ? this->GetHeldRank() : m_Columns.cols());
    this->MakeModes(keep(m_Variances, this->GetTotalVariance()));
  }

  Eigen::Index
  GetCount() const
  {
    return m_Count;
  }
  const Eigen::VectorXd &
  GetMean() const
  {
    return m_Mean;
  }
  /** With the count less one in the denominator; what was left out is in it. */
  double
  GetTotalVariance() const
  {
    return m_Total / static_cast<double>(m_Count - 1);
  }
  /** Whether something was left out, by which variances may be too small and modes inexact. */
  bool
  IsTruncated() const
  {
    return m_Truncated;
  }
  /** After Finish(): descending. */
  const Eigen::VectorXd &
  GetVariances() const
  {
    return m_Variances;
  }
  const Eigen::MatrixXd &
  GetModes() const
  {
    return m_Columns;
  }
  /** The modes for their new owner. */
  Eigen::MatrixXd
  TakeModes()
  {
    return std::move(m_Columns);
  }

private:
  /** Columns of a factor with room left for vectors. */
  Eigen::Index
  GetHeldRank() const
  {
    return std::max(m_Columns.cols() / 2, m_Started);
  }
  /** Takes the vectors since the last one into the factor of at most `rank` columns. */
  void
  Merge(Eigen::Index rank);
  void
  MakeModes(Eigen::Index count);

  Execution       m_Execution;
  Eigen::MatrixXd m_Columns;      ///< factor, then vectors since, then a place for the mean's shift
  Eigen::Index    m_Rank{ 0 };    ///< columns of the factor
  Eigen::Index    m_Started{ 0 }; ///< columns that it began with, which are not given up for want of memory
  Eigen::Index    m_Pending{ 0 }; ///< vectors since
  Eigen::Index    m_Count{ 0 };   ///< vectors in the factor
  Eigen::VectorXd m_Mean;         ///< theirs
  Eigen::VectorXd m_Variances;    ///< of the factor, at the last merge
  double          m_Total{ 0.0 }; ///< squares about the mean
  bool            m_Truncated{ false };
};

/** products(i, j) = column i of a times column j of b; the same for any number of threads. */
void
InnerProducts(const Execution &                         execution,
              const Eigen::Ref<const Eigen::MatrixXd> & a,
              const Eigen::Ref<const Eigen::MatrixXd> & b,
              Eigen::Ref<Eigen::MatrixXd>               products);

/** The first columns become the combinations of the first factors.rows() columns, in place. */
void
CombineColumns(const Execution & execution, const Eigen::MatrixXd & factors, Eigen::Ref<Eigen::MatrixXd> columns);

/** How many of the variances are not rounding beside the largest. */
Eigen::Index
CountAboveRounding(const Eigen::VectorXd & variances);
} // namespace bone

#endif
