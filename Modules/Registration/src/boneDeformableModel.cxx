/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDeformableModel.h"

#include "boneMeanDensities.h"
#include "boneResidualModes.h"
#include "boneSmoothModes.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
/** One standard deviation of mode k. */
Eigen::VectorXd
ScaledMode(const PrincipalModes & modes, Eigen::Index k)
{
  return std::sqrt(modes.variances[k]) * modes.modes.col(k);
}

/** Diagonal of the bounding box. */
double
ExtentOf(const std::vector<Vector3> & points)
{
  Vector3 lower = points.front(), upper = lower;
  for (const Vector3 & x : points)
  {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  return (upper - lower).norm();
}

Eigen::Index
CountOf(const PrincipalModes & modes, int most)
{
  return most == 0 ? modes.GetNumberOfModes() : std::min<Eigen::Index>(most, modes.GetNumberOfModes());
}
} // namespace

DeformableModel::DeformableModel(const StatisticalModelContent &        atlas,
                                 const DeformableRadiographParameters & parameters)
  : mean(atlas.mean)
  , meanDensities(WithMeanDensities(atlas.mean))
  , shapeModes(CountOf(atlas.shape, parameters.shapeModes))
  , densityModes(CountOf(atlas.density, parameters.densityModes))
{
  PrincipalModes smooth;
  if (parameters.smoothModes > 0)
  {
    const double length = parameters.smoothLength > 0.0 ? parameters.smoothLength : ExtentOf(mean.points) / 12.0;
    smooth = parameters.smoothDeviation > 0.0
               ? SmoothModes(mean.points, parameters.smoothDeviation, length, parameters.smoothModes)
               : ResidualModes(atlas, length, parameters.smoothModes);
    restVariance = (smooth.totalVariance - smooth.variances.sum()) / static_cast<double>(smooth.GetDimension());
  }
  smoothModes = smooth.GetNumberOfModes();
  for (Eigen::Index k = 0; k < shapeModes; ++k)
  {
    displacements.push_back(UnstackPoints(ScaledMode(atlas.shape, k)));
  }
  for (Eigen::Index k = 0; k < smoothModes; ++k)
  {
    displacements.push_back(UnstackPoints(ScaledMode(smooth, k)));
  }
  for (Eigen::Index k = 0; k < densityModes; ++k)
  {
    const Eigen::VectorXd mode = ScaledMode(atlas.density, k);
    densities.emplace_back(mode.data(), mode.data() + mode.size());
  }
}

std::vector<Vector3>
DeformableModel::MovePoints(const Eigen::VectorXd & coefficients) const
{
  std::vector<Vector3> points = mean.points;
  for (std::size_t k = 0; k < displacements.size(); ++k)
  {
    const double b = coefficients[static_cast<Eigen::Index>(k)];
    for (std::size_t p = 0; p < points.size() && b != 0.0; ++p)
    {
      points[p] += b * displacements[k][p];
    }
  }
  return points;
}

MeshArrays
DeformableModel::Synthesize(const Eigen::VectorXd & coefficients) const
{
  MeshArrays mesh = mean;
  mesh.points = this->MovePoints(coefficients);
  for (std::size_t k = 0; k < densities.size(); ++k)
  {
    const double b = coefficients[static_cast<Eigen::Index>(displacements.size() + k)];
    for (std::size_t i = 0; i < mesh.coefficients.size() && b != 0.0; ++i)
    {
      mesh.coefficients[i] += b * densities[k][i];
    }
  }
  return mesh;
}
} // namespace bone
