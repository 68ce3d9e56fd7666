/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneEvolutionStrategy.h"

#include <gtest/gtest.h>

#include <functional>

namespace EvolutionStrategyTests
{
using bone::EvolutionStrategy;

Eigen::VectorXd
Minimise(EvolutionStrategy & strategy, int generations, const std::function<double(const Eigen::VectorXd &)> & f)
{
  while (strategy.GetGeneration() < generations && !strategy.IsConverged(1e-8))
  {
    const Eigen::MatrixXd candidates = strategy.Ask();
    Eigen::VectorXd       costs(candidates.cols());
    for (Eigen::Index i = 0; i < costs.size(); ++i)
    {
      costs[i] = f(candidates.col(i));
    }
    strategy.Tell(costs);
  }
  return strategy.BestCandidate();
}

TEST(EvolutionStrategy, FindsTheMinimumOfALongValley)
{
  const Eigen::VectorXd truth = (Eigen::VectorXd(4) << 0.3, -0.5, 0.1, 0.7).finished();
  EvolutionStrategy     strategy(Eigen::VectorXd::Zero(4), 0.3, 12, 3);
  const auto            found = Minimise(strategy, 400, [&](const Eigen::VectorXd & x) {
    const Eigen::VectorXd d = x - truth;
    return d.squaredNorm() + 1e4 * std::pow(d[0] + d[1] - d[2], 2); // a hundred times as steep across
  });
  EXPECT_LT((found - truth).norm(), 1e-5);
  EXPECT_LT(strategy.GetGeneration(), 400);
  EXPECT_LT(strategy.BestCost(), 1e-9);
}

TEST(EvolutionStrategy, StaysInTheBox)
{
  EvolutionStrategy strategy(Eigen::VectorXd::Zero(3), 0.5, 12, 3);
  const auto        found = Minimise(strategy, 300, [](const Eigen::VectorXd & x) {
    EXPECT_LE(x.cwiseAbs().maxCoeff(), 1.0);
    return (x - Eigen::Vector3d(2.0, 0.5, 0.0)).squaredNorm();
  });
  EXPECT_LT((found - Eigen::Vector3d(1.0, 0.5, 0.0)).norm(), 1e-3);
}

TEST(EvolutionStrategy, SameSeedSameCandidatesOtherSeedOthers)
{
  EvolutionStrategy a(Eigen::VectorXd::Zero(3), 0.5, 8, 5), b(Eigen::VectorXd::Zero(3), 0.5, 8, 5),
    c(Eigen::VectorXd::Zero(3), 0.5, 8, 6);
  EXPECT_EQ(a.Ask(), b.Ask());
  EXPECT_NE(a.Ask(), c.Ask());
}

TEST(EvolutionStrategy, PassesOverCandidatesWithoutACost)
{
  EvolutionStrategy strategy(Eigen::VectorXd::Zero(2), 0.5, 10, 1);
  const auto        found = Minimise(strategy, 200, [](const Eigen::VectorXd & x) {
    return x[0] < 0.0 ? std::numeric_limits<double>::quiet_NaN() : (x - Eigen::Vector2d(0.5, 0.2)).squaredNorm();
  });
  EXPECT_LT((found - Eigen::Vector2d(0.5, 0.2)).norm(), 1e-4);
}
} // namespace EvolutionStrategyTests
