/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneModeAccumulator.h"

#include "boneSymmetricEigen.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <vector>

namespace bone
{
namespace
{
constexpr Eigen::Index LeastHeld = 32;
constexpr Eigen::Index RowChunk = 1024;    // entries a thread works on
constexpr Eigen::Index ColumnTile = 32;    // vectors of a block that a thread works on
constexpr double       NoiseLevel = 1e-13; // of the largest eigenvalue

/** Calls body(first, count) for runs of `size` of [0, total), the last one shorter. */
template <typename TBody>
void
OverRuns(const Execution & execution, Eigen::Index total, Eigen::Index size, const TBody & body)
{
  execution.Silent().For(static_cast<std::size_t>((total + size - 1) / size), [&](std::size_t i) {
    const Eigen::Index first = static_cast<Eigen::Index>(i) * size;
    body(first, std::min(size, total - first));
  });
}

/** The matrix of inner products of the columns. */
Eigen::MatrixXd
GramMatrix(const Execution & execution, const Eigen::Ref<const Eigen::MatrixXd> & columns)
{
  Eigen::MatrixXd gram(columns.cols(), columns.cols());
  OverRuns(execution, columns.cols(), ColumnTile, [&](Eigen::Index first, Eigen::Index count) {
    const Eigen::Index upTo = first + count; // the lower triangle
    gram.block(first, 0, count, upTo).noalias() = columns.middleCols(first, count).transpose() * columns.leftCols(upTo);
  });
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return gram;
}
} // namespace

void
InnerProducts(const Execution &                         execution,
              const Eigen::Ref<const Eigen::MatrixXd> & a,
              const Eigen::Ref<const Eigen::MatrixXd> & b,
              Eigen::Ref<Eigen::MatrixXd>               products)
{
  OverRuns(execution, a.cols(), ColumnTile, [&](Eigen::Index first, Eigen::Index count) {
    products.middleRows(first, count).noalias() = a.middleCols(first, count).transpose() * b;
  });
}

void
CombineColumns(const Execution & execution, const Eigen::MatrixXd & factors, Eigen::Ref<Eigen::MatrixXd> columns)
{
  OverRuns(execution, columns.rows(), RowChunk, [&](Eigen::Index first, Eigen::Index count) {
    const Eigen::MatrixXd combined = columns.block(first, 0, count, factors.rows()) * factors;
    columns.block(first, 0, count, factors.cols()) = combined;
  });
}

Eigen::Index
CountAboveRounding(const Eigen::VectorXd & variances)
{
  Eigen::Index count = 0;
  while (count < variances.size() && variances[count] > 0 && variances[count] > NoiseLevel * variances[0])
  {
    ++count;
  }
  return count;
}

ModeAccumulator::ModeAccumulator(Eigen::Index      dimension,
                                 Eigen::Index      count,
                                 std::size_t       bytes,
                                 Eigen::Index      most,
                                 const Execution & execution)
  : m_Execution(execution)
  , m_Mean(Eigen::VectorXd::Zero(dimension))
{
  const auto fitting = static_cast<Eigen::Index>(bytes / (sizeof(double) * static_cast<std::size_t>(dimension)));
  const auto held = std::clamp(fitting, LeastHeld, std::max(LeastHeld, most));
  m_Columns.resize(dimension, std::min(count, held) + 1);
}

void
ModeAccumulator::Start(Eigen::Index            count,
                       const Eigen::VectorXd & mean,
                       const Eigen::MatrixXd & modes,
                       const Eigen::VectorXd & variances,
                       double                  total)
{
  m_Count = count;
  m_Mean = mean;
  m_Rank = modes.cols();
  const auto squares = static_cast<double>(count - 1);
  m_Total = squares * total;
  m_Variances = variances;
  m_Started = m_Rank;
  if (m_Rank + LeastHeld > m_Columns.cols())
  {
    m_Columns.resize(mean.size(), m_Rank + LeastHeld);
  }
  m_Columns.leftCols(m_Rank) = modes * (squares * variances).cwiseSqrt().asDiagonal();
}

Eigen::Ref<Eigen::VectorXd>
ModeAccumulator::Next()
{
  if (m_Rank + m_Pending + 1 == m_Columns.cols())
  {
    this->Merge(this->GetHeldRank());
  }
  return m_Columns.col(m_Rank + m_Pending++);
}

void
ModeAccumulator::Merge(Eigen::Index rank)
{
  if (m_Pending == 0)
  {
    return;
  }
  const auto            count = static_cast<double>(m_Pending), before = static_cast<double>(m_Count);
  auto                  vectors = m_Columns.middleCols(m_Rank, m_Pending);
  const Eigen::VectorXd mean = vectors.rowwise().mean();
  vectors.colwise() -= mean;
  m_Columns.col(m_Rank + m_Pending) = std::sqrt(before * count / (before + count)) * (mean - m_Mean);
  m_Mean += count / (before + count) * (mean - m_Mean);
  m_Count += m_Pending;

  const Eigen::Index    columns = m_Rank + m_Pending + (before > 0 ? 1 : 0);
  const Eigen::MatrixXd gram = GramMatrix(m_Execution, m_Columns.leftCols(columns));
  m_Total += gram.diagonal().tail(columns - m_Rank).sum();
  const SymmetricEigen  eigen = EigenOf(gram);
  const Eigen::VectorXd squares = eigen.values.reverse();
  const Eigen::Index    real = CountAboveRounding(squares);
  m_Rank = std::min(real, rank);
  m_Truncated = m_Truncated || m_Rank < real;
  m_Variances = squares.head(m_Rank) / static_cast<double>(m_Count - 1);
  CombineColumns(m_Execution, eigen.vectors.rowwise().reverse().leftCols(m_Rank), m_Columns);
  m_Pending = 0;
}

void
ModeAccumulator::MakeModes(Eigen::Index count)
{
  m_Rank = std::min(m_Rank, count);
  m_Variances.conservativeResize(m_Rank);
  m_Columns.conservativeResize(Eigen::NoChange, m_Rank);
  const Eigen::VectorXd scale = (static_cast<double>(m_Count - 1) * m_Variances).cwiseSqrt().cwiseInverse();
  m_Columns *= scale.asDiagonal();
  if (m_Rank > 0)
  {
    // Cholesky-QR
    const Eigen::LLT<Eigen::MatrixXd> factor(GramMatrix(m_Execution, m_Columns));
    const Eigen::MatrixXd             identity = Eigen::MatrixXd::Identity(m_Rank, m_Rank);
    CombineColumns(m_Execution, factor.matrixU().solve(identity), m_Columns);
  }
}
} // namespace bone
