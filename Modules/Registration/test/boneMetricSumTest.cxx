/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMetricSum.h"

#include <gtest/gtest.h>

namespace MetricSumTests
{
using namespace bone;

/** Of five parameters, with four by three blocks. */
MetricValue
Value(unsigned int seed)
{
  std::srand(seed); // Eigen's random numbers
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(5, 9);
  MetricValue           value;
  value.cost = 0.25;
  value.hessian = root * root.transpose();
  value.shares = Eigen::MatrixXd::Random(5, 12);
  value.gradient = value.shares.rowwise().sum();
  value.blocksInRow = 4;
  return value;
}

/** Without the parameter number `left`. */
MetricValue
Without(MetricValue value, int left)
{
  Eigen::MatrixXd keep(4, 5);
  for (int i = 0; i < 4; ++i)
  {
    keep.row(i) = Eigen::RowVectorXd::Unit(5, i < left ? i : i + 1);
  }
  value.gradient = keep * value.gradient;
  value.hessian = keep * value.hessian * keep.transpose();
  value.shares = keep * value.shares;
  return value;
}

TEST(MetricSum, LeavesAParameterOut)
{
  for (const int left : { 0, 2, 4 })
  {
    MetricSum all(5), fewer(4);
    for (const unsigned int seed : { 1u, 2u })
    {
      all.Add(Value(seed), 0.5);
      fewer.Add(Without(Value(seed), left), 0.5);
    }
    const MetricSum rest = all.Without(left);
    EXPECT_EQ(rest.cost, fewer.cost);
    EXPECT_TRUE(rest.gradient.isApprox(fewer.gradient));
    EXPECT_TRUE(rest.hessian.isApprox(fewer.hessian));
    for (std::size_t k = 0; k < rest.scatters.size(); ++k)
    {
      EXPECT_TRUE(rest.scatters[k].isApprox(fewer.scatters[k])) << k;
    }
    EXPECT_NEAR(rest.EstimatePrecision(), fewer.EstimatePrecision(), 1e-9 * fewer.EstimatePrecision());
  }
}

TEST(MetricSum, ACostThatCountsTwiceHasHalfThePrecision)
{
  MetricSum once(5), twice(5);
  once.Add(Value(1), 1.0);
  twice.Add(Value(1), 2.0);
  EXPECT_NEAR(twice.EstimatePrecision(), 0.5 * once.EstimatePrecision(), 1e-9 * once.EstimatePrecision());
  EXPECT_EQ(MetricSum(3).EstimatePrecision(), 0.0) << "where no parameter changes the cost";
}
} // namespace MetricSumTests
