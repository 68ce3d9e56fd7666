/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneResidualModes.h"

#include "boneSmoothModes.h"
#include "boneSymmetricEigen.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

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

/** What no small rigid motion of the points makes of modes (x1, y1, z1, x2, ... by #modes). */
Eigen::MatrixXd
WithoutRigidMotions(const std::vector<Vector3> & points, const Eigen::MatrixXd & modes)
{
  Eigen::MatrixXd motions(modes.rows(), 6);
  const Vector3   centre =
    std::accumulate(points.begin(), points.end(), Vector3(Vector3::Zero())) / static_cast<double>(points.size());
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    for (int k = 0; k < 3; ++k)
    {
      motions.block<3, 1>(static_cast<Eigen::Index>(3 * p), k) = Vector3::Unit(k);
      motions.block<3, 1>(static_cast<Eigen::Index>(3 * p), 3 + k) = Vector3::Unit(k).cross(points[p] - centre);
    }
  }
  Eigen::MatrixXd rest = modes;
  const auto      eigen = EigenOf<Eigen::Dynamic>(motions.transpose() * motions);
  for (Eigen::Index k = 0; k < eigen.values.size(); ++k)
  {
    if (eigen.values[k] > 1e-10 * eigen.values.maxCoeff())
    {
      const Eigen::VectorXd motion = motions * eigen.vectors.col(k) / std::sqrt(eigen.values[k]);
      rest -= motion * (motion.transpose() * rest);
    }
  }
  return rest;
}

/** The variances of smooth modes, alike for each three of one shape, by expectation maximisation. A column of `left`,
 * in units of the atlas' modes, is a subject less its projection on the others: what that projection leaves of the
 * smooth modes, and a rest that is independent at each point. */
Eigen::VectorXd
EstimateVariances(const Eigen::MatrixXd & smooth, const Eigen::MatrixXd & ofAtlas, const Eigen::MatrixXd & left)
{
  constexpr Eigen::Index axes = 3;
  constexpr int          iterations = 30;
  constexpr double       tiny = 1e-12;
  const Eigen::Index     count = smooth.cols();
  const auto             subjects = static_cast<double>(left.cols());
  const Eigen::MatrixXd  overlap = smooth.transpose() * ofAtlas;
  const Eigen::MatrixXd  beside = smooth.transpose() * smooth - overlap * overlap.transpose();
  const Eigen::MatrixXd  along = overlap * left;
  const double           total = left.squaredNorm() / subjects;
  const double           rest = total / static_cast<double>(smooth.rows());
  const auto             share = [&](const Eigen::VectorXd & squares) {
    Eigen::VectorXd shared(count);
    for (Eigen::Index k = 0; k < count; k += axes)
    {
      const Eigen::Index n = std::min(axes, count - k);
      shared.segment(k, n).setConstant(std::max(tiny * total, squares.segment(k, n).mean()));
    }
    return shared;
  };
  Eigen::VectorXd variances = share(along.rowwise().squaredNorm() / subjects);
  for (int i = 0; i < iterations && rest > 0.0; ++i)
  {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(count);
    Eigen::MatrixXd precision = beside / rest;
    precision.diagonal() += variances.cwiseInverse();
    const Eigen::MatrixXd common = precision.ldlt().solve(Eigen::MatrixXd::Identity(count, count));
    for (Eigen::Index s = 0; s < left.cols(); ++s)
    {
      // Of the atlas' modes, this subject's rest alone is none of the others': one more column (Sherman-Morrison).
      const Eigen::VectorXd own = overlap * left.col(s).normalized() / std::sqrt(rest);
      const Eigen::VectorXd spread = common * own;
      const double          scale = 1.0 / (1.0 + own.dot(spread));
      const Eigen::VectorXd right = along.col(s) / rest;
      const Eigen::VectorXd mean = common * right - scale * spread.dot(right) * spread;
      squares += (mean.cwiseAbs2() + common.diagonal() - scale * spread.cwiseAbs2()) / subjects;
    }
    variances = share(squares);
  }
  return variances;
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
  const Eigen::Index subjects = atlas.shapeScores.rows();
  if (subjects < 4)
  {
    throw std::invalid_argument("what an atlas leaves out is estimated from four subjects or more; this one has the "
                                "scores of " +
                                std::to_string(subjects));
  }
  const Eigen::MatrixXd left = LeaveOneOutResiduals(atlas.shape, atlas.shapeScores);
  PrincipalModes        result = SmoothModes(atlas.mean.points, 1.0, length, modes);
  result.modes = WithoutRigidMotions(atlas.mean.points, result.modes);
  result.variances = EstimateVariances(result.modes, atlas.shape.modes, left);
  // Modes that the atlas left out for their small variance are what it leaves of a subject, too.
  const double ofOthers = left.squaredNorm() / static_cast<double>(subjects);
  const double dropped = std::max(0.0, atlas.shape.totalVariance - atlas.shape.variances.sum());
  result.totalVariance = ofOthers + dropped;
  if (ofOthers > 0.0)
  {
    result.variances *= result.totalVariance / ofOthers;
  }
  return result;
}
} // namespace bone
