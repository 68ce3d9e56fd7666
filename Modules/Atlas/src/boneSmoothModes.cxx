/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSmoothModes.h"

#include "boneSymmetricEigen.h"


#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
/** Columns of L in covariance = L L^T of a field of deviation 1, as many as are asked for or matter. */
Eigen::MatrixXd
PivotedCholesky(const std::vector<Vector3> & points, double length, Eigen::Index columns)
{
  constexpr double least = 1e-4; // of a point's variance
  const auto       count = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd  factor(count, std::min(columns, count));
  Eigen::VectorXd  rest = Eigen::VectorXd::Ones(count);
  for (Eigen::Index k = 0; k < factor.cols(); ++k)
  {
    Eigen::Index pivot = 0;
    if (rest.maxCoeff(&pivot) < least)
    {
      return factor.leftCols(k);
    }
    Eigen::VectorXd column(count);
    for (Eigen::Index i = 0; i < count; ++i)
    {
      const double d2 = (points[static_cast<std::size_t>(i)] - points[static_cast<std::size_t>(pivot)]).squaredNorm();
      column[i] = std::exp(-0.5 * d2 / (length * length));
    }
    column -= factor.leftCols(k) * factor.row(pivot).head(k).transpose();
    factor.col(k) = column / std::sqrt(rest[pivot]);
    rest = (rest - factor.col(k).cwiseAbs2()).cwiseMax(0.0);
  }
  return factor;
}
} // namespace

PrincipalModes
SmoothModes(const std::vector<Vector3> & points, double deviation, double length, int modes)
{
  if (!(deviation > 0.0) || !std::isfinite(deviation) || !(length > 0.0) || !std::isfinite(length) || modes < 0)
  {
    throw std::invalid_argument("smooth modes need a positive deviation and length, and no negative number of modes");
  }
  constexpr Eigen::Index oversampling = 4;
  constexpr double       least = 1e-4; // of the variance
  const auto             count = static_cast<Eigen::Index>(points.size());
  const auto             wanted = static_cast<Eigen::Index>(modes + 2) / 3;
  const Eigen::MatrixXd  factor = PivotedCholesky(points, length, oversampling * wanted);
  // L L^T and L^T L have the same eigenvalues.
  const auto            eigen = EigenOf<Eigen::Dynamic>(factor.transpose() * factor);
  const Eigen::VectorXd values = eigen.values.reverse();
  Eigen::Index          kept = 0;
  while (kept < std::min(wanted, values.size()) && values[kept] > least * static_cast<double>(count))
  {
    ++kept;
  }
  const Eigen::Index used = std::min<Eigen::Index>(3 * kept, modes);
  PrincipalModes     result;
  result.mean = Eigen::VectorXd::Zero(3 * count);
  result.modes = Eigen::MatrixXd::Zero(3 * count, used);
  result.variances.resize(used);
  for (Eigen::Index k = 0; k < used; ++k)
  {
    const double          value = values[k / 3];
    const Eigen::VectorXd scalar = factor * eigen.vectors.col(values.size() - 1 - k / 3) / std::sqrt(value);
    for (Eigen::Index i = 0; i < count; ++i)
    {
      result.modes(3 * i + k % 3, k) = scalar[i];
    }
    result.variances[k] = deviation * deviation * value;
  }
  result.totalVariance = 3.0 * deviation * deviation * static_cast<double>(count);
  return result;
}
} // namespace bone
