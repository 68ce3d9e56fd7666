/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOrthonormalBasis.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

namespace OrthonormalBasisTests
{
using namespace bone;

class OrthonormalBasisOfDegree : public testing::TestWithParam<int>
{
};

TEST_P(OrthonormalBasisOfDegree, HasTheUnitMatrixForItsMeansOfProducts)
{
  const int                               degree = GetParam();
  const Eigen::Index                      count = BernsteinCount(degree);
  const Eigen::MatrixXd &                 t = OrthonormalToBernstein(degree);
  const Eigen::Map<const Eigen::MatrixXd> gram(BernsteinGramMatrix(degree, degree).data(), count, count);
  EXPECT_LT((t.transpose() * gram * t - Eigen::MatrixXd::Identity(count, count)).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((t * BernsteinToOrthonormal(degree) - Eigen::MatrixXd::Identity(count, count)).cwiseAbs().maxCoeff(),
            1e-10);
}

TEST_P(OrthonormalBasisOfDegree, IsThatOfItsBernsteinCoefficientsAlsoAtVertices)
{
  const int       degree = GetParam();
  Eigen::VectorXd values(BernsteinCount(degree));
  for (const Barycentric & mu : { Barycentric(0.1, 0.2, 0.3, 0.4),
                                  Barycentric(1, 0, 0, 0),
                                  Barycentric(0, 0, 1, 0),
                                  Barycentric(0, 0, 0, 1),
                                  Barycentric(0, 0, 0.5, 0.5) })
  {
    OrthonormalBasis(degree, mu, values.data());
    for (Eigen::Index c = 0; c < values.size(); ++c)
    {
      EXPECT_NEAR(BernsteinValue(degree, OrthonormalToBernstein(degree).col(c).data(), mu), values[c], 1e-9);
    }
  }
}

TEST_P(OrthonormalBasisOfDegree, DampingIsTheRatioOfMeanSquareToThatOfCoefficients)
{
  const int degree = GetParam();
  for (int k = 0; k <= degree; ++k)
  {
    for (int c = k == 0 ? 0 : BernsteinCount(k - 1); c < BernsteinCount(k); ++c)
    {
      const double meanSquare = OrthonormalToBernstein(degree).col(c).squaredNorm() / BernsteinCount(degree);
      EXPECT_NEAR(1 / meanSquare / BernsteinDamping(degree, k), 1, 1e-9);
    }
  }
}

TEST_P(OrthonormalBasisOfDegree, ReductionUndoesElevationAndKeepsTheMean)
{
  const int           degree = GetParam();
  std::mt19937        random(7);
  std::vector<double> c(BernsteinCount(degree)), high(BernsteinCount(MaximumBernsteinDegree)), back(c.size());
  for (double & x : c)
  {
    x = std::uniform_real_distribution<double>(-1, 1)(random);
  }
  BernsteinElevate(degree, c.data(), MaximumBernsteinDegree, high.data());
  BernsteinReduce(MaximumBernsteinDegree, high.data(), degree, back.data());
  for (std::size_t i = 0; i < c.size(); ++i)
  {
    EXPECT_NEAR(back[i], c[i], 1e-9);
  }
  double mean = 0;
  BernsteinReduce(degree, c.data(), 0, &mean);
  EXPECT_NEAR(mean, BernsteinIntegral(degree, c.data(), 1.0), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Degrees, OrthonormalBasisOfDegree, testing::Range(0, MaximumBernsteinDegree + 1));

TEST(OrthonormalBasis, RefusesDegreesItDoesNotHave)
{
  double x[4] = {};
  EXPECT_THROW(OrthonormalBasis(9, Barycentric::Zero(), x), std::out_of_range);
  EXPECT_THROW(OrthonormalToBernstein(-1), std::out_of_range);
  EXPECT_THROW(BernsteinReduce(0, x, 1, x), std::out_of_range);
  EXPECT_THROW(BernsteinDamping(2, 3), std::out_of_range);
}
} // namespace OrthonormalBasisTests
