/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneResidualModes.h"

#include "boneSmoothModes.h"
#include "boneSymmetricEigen.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
/** The column `subject` less its projection on the affine hull of the others. */
Eigen::VectorXd
LeftOut(const Eigen::MatrixXd & shapes, Eigen::Index subject)
{
  Eigen::MatrixXd others(shapes.rows(), shapes.cols() - 1);
  others << shapes.leftCols(subject), shapes.rightCols(shapes.cols() - 1 - subject);
  const Eigen::VectorXd mean = others.rowwise().mean();
  others.colwise() -= mean;
  const auto      eigen = EigenOf<Eigen::Dynamic>(others.transpose() * others);
  Eigen::VectorXd rest = shapes.col(subject) - mean;
  for (Eigen::Index k = 0; k < eigen.values.size(); ++k)
  {
    if (eigen.values[k] > 1e-10 * eigen.values.maxCoeff())
    {
      const Eigen::VectorXd mode = others * eigen.vectors.col(k) / std::sqrt(eigen.values[k]);
      rest -= mode.dot(rest) * mode;
    }
  }
  return rest;
}
} // namespace

Eigen::MatrixXd
LeaveOneOutResiduals(const PrincipalModes & modes, const Eigen::MatrixXd & scores)
{
  const Eigen::MatrixXd vectors = (scores * modes.variances.cwiseSqrt().asDiagonal()).transpose();
  Eigen::MatrixXd       left(vectors.rows(), vectors.cols());
  for (Eigen::Index i = 0; i < vectors.cols(); ++i)
  {
    left.col(i) = LeftOut(vectors, i);
  }
  return left;
}

PrincipalModes
ResidualModes(const StatisticalModelContent & atlas, double length, int modes)
{
  constexpr Eigen::Index axes = 3;
  const Eigen::Index     subjects = atlas.shapeScores.rows();
  if (subjects < 4)
  {
    throw std::invalid_argument("what an atlas leaves out is estimated from four subjects or more; this one has the "
                                "scores of " +
                                std::to_string(subjects));
  }
  const Eigen::MatrixXd left = LeaveOneOutResiduals(atlas.shape, atlas.shapeScores);
  PrincipalModes        result = SmoothModes(atlas.mean.points, 1.0, length, modes);
  const Eigen::MatrixXd along = result.modes.transpose() * (atlas.shape.modes * left);
  for (Eigen::Index k = 0; k < result.variances.size(); k += axes)
  {
    const Eigen::Index n = std::min(axes, result.variances.size() - k);
    result.variances.segment(k, n).setConstant(along.middleRows(k, n).squaredNorm() /
                                               static_cast<double>(n * subjects));
  }
  result.totalVariance = left.squaredNorm() / static_cast<double>(subjects) +
                         std::max(0.0, atlas.shape.totalVariance - atlas.shape.variances.sum());
  return result;
}
} // namespace bone
