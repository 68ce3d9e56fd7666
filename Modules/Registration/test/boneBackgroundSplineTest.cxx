/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBackgroundSpline.h"

#include <gtest/gtest.h>

namespace BackgroundSplineTests
{
using namespace bone;

constexpr int    Columns = 23;
constexpr int    Rows = 17;
constexpr double Length = 6.5;

/** #pixels by #B-splines. */
Eigen::MatrixXd
Basis(const BackgroundSpline & spline)
{
  const Eigen::Index n = spline.GetNumberOfCoefficients();
  Eigen::MatrixXd    basis(Columns * Rows, n);
  for (Eigen::Index k = 0; k < n; ++k)
  {
    for (int r = 0; r < Rows; ++r)
    {
      spline.Evaluate(r, Eigen::VectorXd::Unit(n, k), &basis(r * Columns, k));
    }
  }
  return basis;
}

TEST(BackgroundSpline, SumsToOneAndReproducesAPlane)
{
  const BackgroundSpline spline({ { Columns, Rows } }, Length);
  const int              columns = 3 + 4; // 22 / 6.5 is 3 and some more
  const int              rows = 2 + 4;
  ASSERT_EQ(spline.GetNumberOfCoefficients(), columns * rows);
  const Eigen::MatrixXd basis = Basis(spline);
  EXPECT_GE(basis.minCoeff(), 0.0);
  Eigen::VectorXd plane(columns * rows);
  for (Eigen::Index k = 0; k < plane.size(); ++k)
  {
    plane[k] =
      2.0 + 0.3 * Length * static_cast<double>(k % columns - 1) - 0.1 * Length * static_cast<double>(k / columns - 1);
  }
  const Eigen::VectorXd values = basis * plane;
  for (int i = 0; i < Columns * Rows; ++i)
  {
    EXPECT_NEAR(basis.row(i).sum(), 1.0, 1e-12);
    EXPECT_NEAR(values[i], 2.0 + 0.3 * (i % Columns) - 0.1 * (i / Columns), 1e-12);
  }
}

TEST(BackgroundSpline, SecondDerivativesAreContinuous)
{
  // The third derivatives of a B-spline are -3 to 3 per cubed length, and third differences approach them only where
  // the second derivative does not jump. Along rows the B-spline has the factor 4 / 6 at the knot.
  const BackgroundSpline spline({ { 2000, 1 } }, 500.0);
  std::vector<double>    values(2000);
  Eigen::VectorXd        one = Eigen::VectorXd::Zero(spline.GetNumberOfCoefficients());
  one[(spline.GetNumberOfCoefficients() / 4) + 3] = 1.0; // the second of four along rows
  spline.Evaluate(0, one, values.data());
  for (std::size_t i = 3; i < values.size(); ++i)
  {
    const double third = values[i] - 3.0 * values[i - 1] + 3.0 * values[i - 2] - values[i - 3];
    EXPECT_LT(std::abs(third), 1.01 * 4.0 / 6.0 * 3.0 / 1.25e8);
  }
}

TEST(BackgroundSpline, SumsAreThoseOfTheFullMatrix)
{
  const BackgroundSpline spline({ { Columns, Rows } }, Length);
  const Eigen::MatrixXd  basis = Basis(spline);
  const Eigen::Index     n = spline.GetNumberOfCoefficients();
  const Eigen::VectorXd  weights = Eigen::VectorXd::Random(Columns * Rows);
  Eigen::VectorXd        products = Eigen::VectorXd::Zero(n);
  Eigen::MatrixXd        normal = Eigen::MatrixXd::Zero(n, n);
  for (int r = 0; r < Rows; ++r)
  {
    spline.AddProducts(r, &weights[r * Columns], products);
    spline.AddNormalMatrix(r, &weights[r * Columns], normal);
  }
  EXPECT_LT((products - basis.transpose() * weights).norm(), 1e-12);
  const Eigen::MatrixXd difference = normal - basis.transpose() * weights.asDiagonal() * basis;
  EXPECT_LT(Eigen::MatrixXd(difference.triangularView<Eigen::Lower>()).norm(), 1e-12);
}

TEST(BackgroundSpline, ALengthOfNothingHasNoBSplines)
{
  EXPECT_EQ(BackgroundSpline({ { Columns, Rows } }, 0.0).GetNumberOfCoefficients(), 0);
}
} // namespace BackgroundSplineTests
