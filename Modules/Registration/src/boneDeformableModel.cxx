/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDeformableModel.h"

#include "boneMeanDensities.h"
#include "boneResidualModes.h"
#include "boneSmoothModes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

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

constexpr double leastVolume = 1e-30; // a region that is not there

/** How the signed volume of a tetrahedron rises with each of its points. */
std::array<Vector3, 4>
VolumeSlopes(const std::vector<Vector3> & points, const Id4 & ids)
{
  const auto             at = [&](std::size_t v) { return points[static_cast<std::size_t>(ids[v])]; };
  const Vector3          a = at(1) - at(0), b = at(2) - at(0), c = at(3) - at(0);
  std::array<Vector3, 4> slopes{ Vector3::Zero(), b.cross(c) / 6.0, c.cross(a) / 6.0, a.cross(b) / 6.0 };
  slopes[0] = -(slopes[1] + slopes[2] + slopes[3]);
  return slopes;
}

std::vector<Vector3>
Displace(std::vector<Vector3>                      points,
         const std::vector<std::vector<Vector3>> & displacements,
         const Eigen::VectorXd &                   coefficients)
{
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

Eigen::Index
CountOf(const PrincipalModes & modes, int most)
{
  return most == 0 ? modes.GetNumberOfModes() : std::min<Eigen::Index>(most, modes.GetNumberOfModes());
}
} // namespace

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

Eigen::MatrixXd
MeasureCells(const MeshCells & mesh, const std::vector<Vector3> & points, const std::vector<double> & means)
{
  const int       most = mesh.region.empty() ? 0 : *std::max_element(mesh.region.begin(), mesh.region.end());
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(most + 2, 3);
  for (std::size_t t = 0; t < means.size(); ++t)
  {
    const Id4 &  ids = mesh.tetrahedra[t];
    const double volume = SignedVolume(points[static_cast<std::size_t>(ids[0])],
                                       points[static_cast<std::size_t>(ids[1])],
                                       points[static_cast<std::size_t>(ids[2])],
                                       points[static_cast<std::size_t>(ids[3])]);
    for (const Eigen::Index row :
         { static_cast<Eigen::Index>(mesh.region.empty() ? 0 : mesh.region[t]), static_cast<Eigen::Index>(most + 1) })
    {
      sums(row, 0) += volume;
      sums(row, 2) += volume * means[t];
    }
  }
  sums.col(1) = sums.col(2).array() / sums.col(0).array().max(leastVolume);
  return sums;
}

DeformableModel::DeformableModel(const StatisticalModelContent &        atlas,
                                 const DeformableRadiographParameters & parameters)
  : mean(atlas.mean)
  , meanDensities(WithMeanDensities(atlas.mean).coefficients)
  , shapeModes(CountOf(atlas.shape, parameters.shapeModes))
  , densityModes(CountOf(atlas.density, parameters.densityModes))
{
  PrincipalModes smooth;
  if (parameters.smoothModes > 0)
  {
    if (parameters.smoothDeviation == 0.0 && atlas.shapeScores.rows() < 4)
    {
      throw std::invalid_argument(
        "The atlas has " + std::to_string(atlas.shapeScores.rows()) +
        " subjects, and what its modes leave of a bone is estimated from four or more: give no smooth "
        "modes (0), or their deviation.");
    }
    const double length = parameters.smoothLength > 0.0 ? parameters.smoothLength : ExtentOf(mean.points) / 12.0;
    smooth = parameters.smoothDeviation > 0.0
               ? SmoothModes(mean.points, parameters.smoothDeviation, length, parameters.smoothModes)
               : ResidualModes(atlas, length, parameters.smoothModes);
    residualVariance = smooth.totalVariance / static_cast<double>(smooth.GetDimension());
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
    this->AddDensity({ mode.data(), mode.data() + mode.size() });
  }
  this->AddRegions(atlas);
  densityModes = static_cast<Eigen::Index>(densities.size());
}

void
DeformableModel::AddDensity(const std::vector<double> & change)
{
  MeshArrays mesh = mean;
  mesh.coefficients = change;
  cellDensities.push_back(WithMeanDensities(mesh).coefficients);
  densities.push_back(change);
}

void
DeformableModel::AddRegions(const StatisticalModelContent & atlas)
{
  if (mean.region.empty() || atlas.densityScores.rows() < 4)
  {
    return;
  }
  // Mean density of each region, of what is left of each subject.
  const Eigen::MatrixXd left = atlas.density.modes * LeaveOneOutResiduals(atlas.density, atlas.densityScores);
  const Eigen::MatrixXd volumes = MeasureCells(mean, mean.points, meanDensities);
  Eigen::VectorXd       sum = Eigen::VectorXd::Zero(volumes.rows());
  MeshArrays            rest = mean;
  for (Eigen::Index i = 0; i < left.cols(); ++i)
  {
    rest.coefficients.assign(left.col(i).data(), left.col(i).data() + left.rows());
    const auto means = WithMeanDensities(rest).coefficients;
    sum += MeasureCells(mean, mean.points, means).col(1).cwiseAbs2() / static_cast<double>(left.cols());
  }
  const std::size_t row = mean.coefficients.size() / mean.tetrahedra.size();
  for (Eigen::Index r = 0; r + 1 < sum.size(); ++r)
  {
    std::vector<double> change(mean.coefficients.size(), 0.0);
    for (std::size_t t = 0; t < mean.tetrahedra.size(); ++t)
    {
      if (mean.region[t] == r)
      {
        std::fill_n(change.begin() + static_cast<std::ptrdiff_t>(t * row), row, std::sqrt(sum[r]));
      }
    }
    constexpr double rounding = 1e-12;
    if (volumes(r, 0) > 0.0 && sum[r] > rounding * sum.maxCoeff())
    {
      this->AddDensity(change);
    }
  }
}

std::vector<Vector3>
DeformableModel::MovePoints(const Eigen::VectorXd & coefficients) const
{
  return Displace(mean.points, displacements, coefficients);
}

std::vector<Vector3>
CoarseModel::MovePoints(const Eigen::VectorXd & coefficients) const
{
  return Displace(mesh.points, displacements, coefficients);
}

CoarseModel
DeformableModel::Coarsen(std::size_t tetrahedra, Eigen::Index modes, const Execution & execution) const
{
  BuiltLevel                  level = SimplifyMeans(mean, tetrahedra, execution);
  const std::vector<IdType> & kept = level.parentPoint;
  CoarseModel                 coarse{ std::move(level.mesh), {} };
  for (Eigen::Index k = 0; k < std::min(modes, shapeModes); ++k)
  {
    const std::vector<Vector3> & mode = displacements[static_cast<std::size_t>(k)];
    std::vector<Vector3>         ofKept(kept.size());
    std::transform(
      kept.begin(), kept.end(), ofKept.begin(), [&mode](IdType p) { return mode[static_cast<std::size_t>(p)]; });
    coarse.displacements.push_back(std::move(ofKept));
  }
  return coarse;
}

Eigen::MatrixXd
DeformableModel::MeasureRegions(const Eigen::VectorXd & coefficients) const
{
  return MeasureCells(mean, this->MovePoints(coefficients), this->CellDensities(coefficients));
}

std::vector<double>
DeformableModel::CellDensities(const Eigen::VectorXd & coefficients) const
{
  std::vector<double> means = meanDensities;
  for (std::size_t k = 0; k < cellDensities.size(); ++k)
  {
    const double b = coefficients[static_cast<Eigen::Index>(displacements.size() + k)];
    for (std::size_t t = 0; t < means.size() && b != 0.0; ++t)
    {
      means[t] += b * cellDensities[k][t];
    }
  }
  return means;
}

std::vector<Eigen::MatrixXd>
DeformableModel::RegionSlopes(const Eigen::VectorXd & coefficients) const
{
  const std::vector<Vector3> points = this->MovePoints(coefficients);
  const std::vector<double>  means = this->CellDensities(coefficients);
  const Eigen::MatrixXd      at = MeasureCells(mean, points, means);
  const Eigen::Index         whole = at.rows() - 1;
  const auto                 size = static_cast<Eigen::Index>(3 * points.size());
  const auto                 regionOf = [this](std::size_t t) { return mean.region.empty() ? 0 : mean.region[t]; };
  // By the coordinates of the points.
  Eigen::MatrixXd ofVolume = Eigen::MatrixXd::Zero(size, at.rows()), ofMass = ofVolume;
  for (std::size_t t = 0; t < means.size(); ++t)
  {
    const Id4 &                  ids = mean.tetrahedra[t];
    const std::array<Vector3, 4> slopes = VolumeSlopes(points, ids);
    for (std::size_t v = 0; v < 4; ++v)
    {
      for (const Eigen::Index row : { static_cast<Eigen::Index>(regionOf(t)), whole })
      {
        ofVolume.col(row).segment<3>(3 * ids[v]) += slopes[v];
        ofMass.col(row).segment<3>(3 * ids[v]) += means[t] * slopes[v];
      }
    }
  }
  std::vector<Eigen::MatrixXd> result;
  const auto                   put = [&](const Eigen::VectorXd & volume, const Eigen::VectorXd & mass) {
    Eigen::MatrixXd slope(at.rows(), 3);
    slope.col(0) = volume;
    slope.col(1) = (mass - at.col(1).cwiseProduct(volume)).array() / at.col(0).array().max(leastVolume);
    slope.col(2) = mass;
    result.push_back(std::move(slope));
  };
  for (const auto & displacement : displacements)
  {
    const Eigen::VectorXd move = StackPoints(displacement);
    put(ofVolume.transpose() * move, ofMass.transpose() * move);
  }
  for (const auto & change : cellDensities)
  {
    put(Eigen::VectorXd::Zero(at.rows()), MeasureCells(mean, points, change).col(2));
  }
  return result;
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
