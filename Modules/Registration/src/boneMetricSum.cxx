/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMetricSum.h"

#include <Eigen/Cholesky>

#include <algorithm>

namespace bone
{
namespace
{
/** Covariance of the sum of the shares, where blocks of `width` by `width` are independent. */
Eigen::MatrixXd
ScatterOf(const MetricValue & value, Eigen::Index width)
{
  const Eigen::Index inRow = value.blocksInRow, rows = value.shares.cols() / inRow;
  const Eigen::Index merged = (inRow + width - 1) / width;
  Eigen::MatrixXd    sums = Eigen::MatrixXd::Zero(value.shares.rows(), merged * ((rows + width - 1) / width));
  for (Eigen::Index b = 0; b < value.shares.cols(); ++b)
  {
    sums.col(b / inRow / width * merged + b % inRow / width) += value.shares.col(b);
  }
  return sums * sums.transpose();
}

Eigen::VectorXd
WithoutRow(const Eigen::VectorXd & vector, Eigen::Index row)
{
  Eigen::VectorXd rest(vector.size() - 1);
  rest << vector.head(row), vector.tail(rest.size() - row);
  return rest;
}

/** Without a row and the column of the same number. */
Eigen::MatrixXd
WithoutRowAndColumn(const Eigen::MatrixXd & matrix, Eigen::Index row)
{
  const Eigen::Index size = matrix.rows() - 1, after = size - row;
  Eigen::MatrixXd    rest(size, size);
  rest << matrix.topLeftCorner(row, row), matrix.topRightCorner(row, after), matrix.bottomLeftCorner(after, row),
    matrix.bottomRightCorner(after, after);
  return rest;
}
} // namespace

MetricSum::MetricSum(Eigen::Index parameters)
  : gradient(Eigen::VectorXd::Zero(parameters))
  , hessian(Eigen::MatrixXd::Zero(parameters, parameters))
{
  scatters.fill(hessian);
}

void
MetricSum::Add(const MetricValue & value, double share)
{
  cost += share * value.cost;
  gradient += share * value.gradient;
  hessian += share * value.hessian;
  for (std::size_t k = 0; k < scatters.size() && value.shares.cols() > 0; ++k)
  {
    scatters[k] += share * share * ScatterOf(value, Eigen::Index{ 1 } << k);
  }
}

MetricSum
MetricSum::Without(Eigen::Index parameter) const
{
  MetricSum rest(gradient.size() - 1);
  rest.cost = cost;
  rest.gradient = WithoutRow(gradient, parameter);
  rest.hessian = WithoutRowAndColumn(hessian, parameter);
  std::transform(scatters.begin(), scatters.end(), rest.scatters.begin(), [parameter](const Eigen::MatrixXd & scatter) {
    return WithoutRowAndColumn(scatter, parameter);
  });
  return rest;
}

double
MetricSum::EstimatePrecision() const
{
  constexpr double damping = 1e-2;
  constexpr double least = 1e-9; // of the largest curvature: what the images do not show counts nothing
  if (!(hessian.diagonal().maxCoeff() > 0.0))
  {
    return 0.0;
  }
  const Eigen::VectorXd scale =
    hessian.diagonal().cwiseMax(least * hessian.diagonal().maxCoeff()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
  Eigen::MatrixXd       damped = scaled;
  damped.diagonal().array() += damping;
  // The trace of a product of symmetric matrices is the sum of the products of their elements.
  const Eigen::MatrixXd inverse = damped.ldlt().solve(Eigen::MatrixXd::Identity(damped.rows(), damped.cols()));
  const double          curvature = inverse.cwiseProduct(scaled).sum();
  double                largest = 0.0;
  for (const Eigen::MatrixXd & scatter : scatters)
  {
    largest = std::max(largest, inverse.cwiseProduct(scale.asDiagonal() * scatter * scale.asDiagonal()).sum());
  }
  return largest > 0.0 ? curvature / largest : 0.0;
}
} // namespace bone
