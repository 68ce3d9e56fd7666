/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSparseCholesky.h"

#include <gtest/gtest.h>

namespace SparseCholeskyTests
{
/** A chain of springs held at both ends and, `far` apart, tied together; every element comes as two halves. */
std::vector<bone::SparseEntry>
Chain(Eigen::Index size, Eigen::Index far, double stiffness)
{
  std::vector<bone::SparseEntry> entries;
  const auto                     tie = [&](Eigen::Index a, Eigen::Index b) {
    for (int half = 0; half < 2; ++half)
    {
      entries.push_back({ a, a, 0.5 * stiffness });
      entries.push_back({ b, b, 0.5 * stiffness });
      entries.push_back({ std::max(a, b), std::min(a, b), -0.5 * stiffness });
    }
  };
  for (Eigen::Index i = 0; i < size; ++i)
  {
    entries.push_back({ i, i, 1.0 });
    if (i + 1 < size)
    {
      tie(i, i + 1);
    }
    if (i + far < size)
    {
      tie(i, i + far);
    }
  }
  return entries;
}

void
ExpectSolves(bone::SparseCholesky & factor, Eigen::Index size, const std::vector<bone::SparseEntry> & entries)
{
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
  for (const bone::SparseEntry & entry : entries)
  {
    dense(entry.row(), entry.col()) += entry.value();
  }
  const Eigen::MatrixXd right = Eigen::MatrixXd::Random(size, 3);
  ASSERT_TRUE(factor.Factorize(size, entries));
  const Eigen::MatrixXd product = dense.selfadjointView<Eigen::Lower>() * factor.Solve(right);
  EXPECT_LT((product - right).norm(), 1e-10);
}

TEST(SparseCholesky, SolvesOneMatrixAfterAnother)
{
  bone::SparseCholesky factor;
  ExpectSolves(factor, 20, Chain(20, 5, 1.0));
  ExpectSolves(factor, 20, Chain(20, 5, 7.0)); // the same places
  ExpectSolves(factor, 20, Chain(20, 4, 7.0)); // others
  ExpectSolves(factor, 12, Chain(12, 5, 2.0));
}

TEST(SparseCholesky, SaysThatAMatrixHasNoFactor)
{
  bone::SparseCholesky factor;
  EXPECT_FALSE(factor.Factorize(2, { { 0, 0, 1.0 }, { 1, 0, 1.0 }, { 1, 1, 1.0 } }));
  ExpectSolves(factor, 2, { { 0, 0, 1.0 }, { 1, 0, 1.0 }, { 1, 1, 2.0 } });
}
} // namespace SparseCholeskyTests
