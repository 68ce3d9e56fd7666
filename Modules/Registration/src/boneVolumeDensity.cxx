/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVolumeDensity.h"

#include "boneBernstein.h"
#include "boneDeformableModel.h"
#include "boneMeanDensities.h"
#include "boneReflection.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <stdexcept>

namespace bone
{
namespace
{
/** The most probable coefficients of the modes of density, by some tetrahedra of a mesh in the topology of the atlas.
 */
Eigen::VectorXd
ScoreDensity(const StatisticalModelContent & atlas, const MeshArrays & mesh, const std::vector<bool> & beyond)
{
  const Eigen::Index modes = atlas.density.GetNumberOfModes();
  const auto         row = static_cast<Eigen::Index>(BernsteinCount(mesh.maximumDegree));
  const auto         shown = static_cast<Eigen::Index>(std::count(beyond.begin(), beyond.end(), false));
  if (modes == 0 || shown == 0)
  {
    return Eigen::VectorXd::Zero(modes);
  }
  Eigen::MatrixXd vectors(shown * row, modes);
  Eigen::VectorXd rest(shown * row);
  Eigen::Index    to = 0;
  for (std::size_t t = 0; t < beyond.size(); ++t)
  {
    if (!beyond[t])
    {
      const auto from = static_cast<Eigen::Index>(t) * row;
      vectors.middleRows(to, row) =
        atlas.density.modes.middleRows(from, row) * atlas.density.variances.cwiseSqrt().asDiagonal();
      rest.segment(to, row) =
        Eigen::Map<const Eigen::VectorXd>(mesh.coefficients.data() + from, row) - atlas.density.mean.segment(from, row);
      to += row;
    }
  }
  // What the modes leave has the variance of what they leave of a subject; first a guess, then that.
  const Eigen::MatrixXd square = vectors.transpose() * vectors;
  const Eigen::VectorXd along = vectors.transpose() * rest;
  Eigen::VectorXd       scores = Eigen::VectorXd::Zero(modes);
  for (int round = 0; round < 3; ++round)
  {
    const double variance = std::max((rest - vectors * scores).squaredNorm() / static_cast<double>(rest.size()), 1e-12);
    Eigen::MatrixXd precision = square / variance;
    precision.diagonal().array() += 1.0;
    scores = precision.ldlt().solve(along / variance);
  }
  return scores;
}

void
MeasureDensities(const AtlasVolumeParameters & p, VolumeRegistrationResult & result)
{
  const Eigen::MatrixXd table =
    MeasureCells(result.mesh, result.mesh.points, WithMeanDensities(result.mesh).coefficients);
  for (RegionEstimate & region : result.regions)
  {
    region.mass = table(region.region < 0 ? table.rows() - 1 : region.region, 2);
    region.density = region.mass / region.volume;
    const double half = 0.5 * (p.softTissue + region.density);
    region.massDeviation = std::abs(half) * region.volumeDeviation;
    region.densityDeviation = std::abs(half - region.density) * region.volumeDeviation / region.volume;
  }
}
} // namespace

std::vector<bool>
CellsBeyond(const MeshArrays & mesh, const VolumeView & ct)
{
  std::vector<bool> shown(mesh.points.size());
  double            value;
  std::transform(
    mesh.points.begin(), mesh.points.end(), shown.begin(), [&](const Vector3 & x) { return ct.Sample(x, value); });
  std::vector<bool> beyond(mesh.tetrahedra.size());
  std::transform(mesh.tetrahedra.begin(), mesh.tetrahedra.end(), beyond.begin(), [&](const Id4 & ids) {
    return !std::all_of(ids.begin(), ids.end(), [&](IdType p) { return shown[static_cast<std::size_t>(p)]; });
  });
  return beyond;
}

void
TakeVolumeDensity(const StatisticalModelContent & atlas,
                  const VolumeView &              ct,
                  const AtlasVolumeParameters &   parameters,
                  const MeshArrays &              fitted,
                  VolumeRegistrationResult &      result)
{
  MeshArrays & mesh = result.mesh;
  if (fitted.maximumDegree != mesh.maximumDegree)
  {
    throw std::invalid_argument("The density is fitted with degree " + std::to_string(fitted.maximumDegree) +
                                ", and the atlas has " + std::to_string(mesh.maximumDegree) + ".");
  }
  const std::vector<bool> beyond = CellsBeyond(mesh, ct);
  const auto              row = static_cast<std::ptrdiff_t>(BernsteinCount(mesh.maximumDegree));
  for (std::size_t t = 0; t < beyond.size(); ++t)
  {
    if (!beyond[t])
    {
      const auto from = static_cast<std::ptrdiff_t>(t) * row;
      std::copy_n(fitted.coefficients.begin() + from, row, mesh.coefficients.begin() + from);
      mesh.degree[t] = fitted.degree[t];
    }
  }
  mesh.quantity = fitted.quantity;
  MeasureDensities(parameters, result);
  result.densityScores = ScoreDensity(atlas, result.mirrored ? ReflectMesh(mesh) : mesh, beyond);
}
} // namespace bone
