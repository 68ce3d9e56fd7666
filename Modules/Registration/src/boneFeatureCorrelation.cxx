/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFeatureCorrelation.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace bone
{
namespace
{
constexpr double edgeShare = 0.6; // of a voxel, to each side of an edge
constexpr double counts = 60.0;   ///< how many independent samples a bone's correlation counts as

std::size_t
NearestPoint(const std::vector<Vector3> & points, const Vector3 & x)
{
  std::size_t best = 0;
  double      least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    const double d = (points[p] - x).squaredNorm();
    if (d < least)
    {
      least = d;
      best = p;
    }
  }
  return best;
}

/** Voxels in the bone (above `outside`) or beside one that is. */
std::vector<std::size_t>
VoxelsAbout(const VoxelVolume & volume, const std::vector<bool> & inside)
{
  std::vector<std::size_t> found;
  const auto &             size = volume.grid.size;
  for (int k = 0; k < size[2]; ++k)
  {
    for (int j = 0; j < size[1]; ++j)
    {
      for (int i = 0; i < size[0]; ++i)
      {
        bool near = false;
        for (int n = 0; n < 27 && !near; ++n)
        {
          const int a = i + n % 3 - 1, b = j + n / 3 % 3 - 1, c = k + n / 9 - 1;
          near = a >= 0 && b >= 0 && c >= 0 && a < size[0] && b < size[1] && c < size[2] &&
                 inside[(static_cast<std::size_t>(c) * size[1] + b) * size[0] + a];
        }
        if (near)
        {
          found.push_back((static_cast<std::size_t>(k) * size[1] + j) * size[0] + i);
        }
      }
    }
  }
  return found;
}

Vector3
CentreOfVoxel(const VoxelGrid & grid, std::size_t voxel)
{
  const auto row = static_cast<std::size_t>(grid.size[0]), slice = row * grid.size[1];
  return grid.Centre(
    static_cast<int>(voxel % row), static_cast<int>(voxel % slice / row), static_cast<int>(voxel / slice));
}
} // namespace

std::vector<VolumeEdge>
FindEdges(const VoxelVolume & volume)
{
  constexpr double        least = 0.1;
  std::vector<VolumeEdge> edges;
  const VolumeView        view = volume.View();
  const auto &            size = volume.grid.size;
  const std::ptrdiff_t    strides[3] = { 1, size[0], static_cast<std::ptrdiff_t>(size[0]) * size[1] };
  for (int k = 1; k + 1 < size[2]; ++k)
  {
    for (int j = 1; j + 1 < size[1]; ++j)
    {
      for (int i = 1; i + 1 < size[0]; ++i)
      {
        const float * at = volume.values.data() + i + j * strides[1] + k * strides[2];
        Vector3       byIndex;
        for (int axis = 0; axis < 3; ++axis)
        {
          byIndex[axis] = 0.5 * (static_cast<double>(at[strides[axis]]) - static_cast<double>(at[-strides[axis]]));
        }
        if (byIndex.norm() > least)
        {
          edges.push_back(
            { volume.grid.Centre(i, j, k), -(view.toIndex.transpose() * byIndex).normalized(), Vector3::Zero() });
        }
      }
    }
  }
  return edges;
}

FeatureCorrelation::FeatureCorrelation(const DeformableModel & model,
                                       const VolumeView &      ct,
                                       double                  spacing,
                                       double                  softTissue,
                                       std::size_t             samples,
                                       Eigen::Index            modes,
                                       const Execution &       execution)
  : m_Image(AverageBlocks(ct, spacing, BoneLikeness, execution))
  , m_EdgeStep(edgeShare * spacing)
{
  constexpr double  fineness = 4.0; // voxels of the raster in one of the map
  const double      step = spacing / fineness;
  const VoxelVolume raster = RasterizeMesh(model.mean, step, 2.5 * spacing, -1e4, execution);
  const auto        inside = [](double v) { return v > -9e3 ? 1.0 : 0.0; };
  const VoxelVolume bone = AverageBlocks(
    raster.View(), spacing, [&](double v) { return v > -9e3 ? BoneLikeness(v) : BoneLikeness(softTissue); }, execution);
  const VoxelVolume share = AverageBlocks(raster.View(), spacing, inside, execution);
  m_ModelEdges = FindEdges(bone);
  std::mt19937_64 random(1);
  std::shuffle(m_ModelEdges.begin(), m_ModelEdges.end(), random);
  m_ImageEdges = FindEdges(m_Image);
  for (VolumeEdge & edge : m_ModelEdges)
  {
    if (modes > 0 && model.shapeModes > 0)
    {
      edge.leading = model.displacements[0][NearestPoint(model.mean.points, edge.point)];
    }
  }

  std::vector<bool> some(share.values.size());
  std::transform(share.values.begin(), share.values.end(), some.begin(), [](float s) { return s > 0.25F; });
  std::vector<std::size_t> voxels = VoxelsAbout(bone, some);
  std::shuffle(voxels.begin(), voxels.end(), random);
  voxels.resize(std::min(samples, voxels.size()));
  m_Displacements.resize(static_cast<std::size_t>(std::min(modes, model.shapeModes)));
  for (const std::size_t voxel : voxels)
  {
    m_Points.push_back(CentreOfVoxel(bone.grid, voxel));
    m_Values.push_back(static_cast<double>(bone.values[voxel]));
    const std::size_t nearest = NearestPoint(model.mean.points, m_Points.back());
    for (std::size_t mode = 0; mode < m_Displacements.size(); ++mode)
    {
      m_Displacements[mode].push_back(model.displacements[mode][nearest]);
    }
  }
}

Vector3
FeatureCorrelation::Place(std::size_t sample, const VolumeCandidate & candidate) const
{
  Vector3 x = m_Points[sample];
  for (std::size_t k = 0; k < std::min<std::size_t>(candidate.coefficients.size(), m_Displacements.size()); ++k)
  {
    x += candidate.coefficients[static_cast<Eigen::Index>(k)] * m_Displacements[k][sample];
  }
  return x;
}

void
FeatureCorrelation::Correlate(VolumeCandidate & candidate) const
{
  const VolumeView image = m_Image.View();
  double           n = 0, all = 0, f = 0, m = 0, ff = 0, mm = 0, fm = 0;
  for (std::size_t i = 0; i < m_Points.size(); ++i)
  {
    double value;
    all += 1;
    if (image.Sample(candidate.pose.Apply(this->Place(i, candidate)), value))
    {
      n += 1;
      f += value;
      m += m_Values[i];
      ff += value * value;
      mm += m_Values[i] * m_Values[i];
      fm += value * m_Values[i];
    }
  }
  candidate.share = n / std::max(all, 1.0);
  const double varianceF = ff - f * f / std::max(n, 1.0), varianceM = mm - m * m / std::max(n, 1.0);
  candidate.correlation =
    varianceF > 1e-9 && varianceM > 1e-9 ? (fm - f * m / n) / std::sqrt(varianceF * varianceM) : 0.0;
}

void
FeatureCorrelation::ScoreEdges(VolumeCandidate & candidate, std::size_t stride) const
{
  constexpr double full = 0.25; // fall of the map that counts as a whole edge
  const VolumeView image = m_Image.View();
  const double     size = candidate.coefficients.size() > 0 ? candidate.coefficients[0] : 0.0;
  double           sum = 0.0, n = 0.0, all = 0.0;
  for (std::size_t i = 0; i < m_ModelEdges.size(); i += stride)
  {
    const VolumeEdge & edge = m_ModelEdges[i];
    const Vector3      x = candidate.pose.Apply(edge.point + size * edge.leading);
    const Vector3      step = m_EdgeStep * (candidate.pose.rotation * edge.normal);
    double             inside, outside;
    all += 1.0;
    if (image.Sample(x - step, inside) && image.Sample(x + step, outside))
    {
      n += 1.0;
      sum += std::clamp((inside - outside) / full, -1.0, 1.0);
    }
  }
  candidate.share = n / std::max(all, 1.0);
  candidate.score = n > 0.0 ? std::max(0.0, sum / n) * std::sqrt(candidate.share) : 0.0;
}

double
FeatureCorrelation::Merit(const VolumeCandidate & candidate)
{
  const double r = std::clamp(candidate.correlation, 0.0, 0.999);
  return -0.5 * counts * candidate.share * std::log(1.0 - r * r) - 0.5 * candidate.coefficients.squaredNorm();
}

bool
FeatureCorrelation::FindStep(const VolumeCandidate & candidate, Eigen::VectorXd & step, double damping) const
{
  const VolumeView             image = m_Image.View();
  const Eigen::Index           modes = candidate.coefficients.size();
  std::vector<Eigen::VectorXd> rows;
  std::vector<double>          values, expected;
  for (std::size_t i = 0; i < m_Points.size(); ++i)
  {
    const Vector3 x = this->Place(i, candidate);
    double        value;
    Vector3       gradient;
    if (!image.Sample(candidate.pose.Apply(x), value, &gradient))
    {
      continue;
    }
    const Vector3   g = candidate.pose.rotation.transpose() * gradient;
    Eigen::VectorXd row(RigidPose::Steps + modes);
    row.head<3>() = g;
    row.segment<3>(3) = (x - candidate.pose.centre).cross(g);
    for (Eigen::Index k = 0; k < modes; ++k)
    {
      row[RigidPose::Steps + k] = g.dot(m_Displacements[static_cast<std::size_t>(k)][i]);
    }
    rows.push_back(std::move(row));
    values.push_back(value);
    expected.push_back(m_Values[i]);
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  if (n < 2 * (RigidPose::Steps + modes))
  {
    return false;
  }
  // Residuals after the best factor and offset of the model's map, which the derivatives leave out.
  Eigen::MatrixXd jacobian(n, RigidPose::Steps + modes);
  for (Eigen::Index i = 0; i < n; ++i)
  {
    jacobian.row(i) = rows[static_cast<std::size_t>(i)];
  }
  Eigen::VectorXd f = Eigen::Map<Eigen::VectorXd>(values.data(), n),
                  m = Eigen::Map<Eigen::VectorXd>(expected.data(), n);
  f.array() -= f.mean();
  m.array() -= m.mean();
  m /= std::max(m.norm(), 1e-12);
  Eigen::VectorXd residual = f - f.dot(m) * m;
  jacobian.rowwise() -= jacobian.colwise().mean().eval();
  jacobian -= m * (m.transpose() * jacobian).eval();
  const double    scale = counts / std::max(residual.squaredNorm(), 1e-12);
  Eigen::MatrixXd hessian = scale * jacobian.transpose() * jacobian;
  Eigen::VectorXd slope = scale * jacobian.transpose() * residual;
  hessian.diagonal().tail(modes).array() += 1.0;
  slope.tail(modes) += candidate.coefficients;
  hessian.diagonal() *= 1.0 + damping;
  hessian.diagonal().array() += 1e-9;
  step = -hessian.ldlt().solve(slope);
  // A step leads no further than the maps tell of.
  const double length = step.head<3>().norm(), turn = step.segment<3>(3).norm();
  step *= std::min({ 1.0, 20.0 / std::max(length, 1e-12), 0.3 / std::max(turn, 1e-12) });
  return step.allFinite();
}

void
FeatureCorrelation::Refine(VolumeCandidate & candidate, int iterations) const
{
  this->Correlate(candidate);
  double damping = 0.1;
  int    refused = 0;
  for (int i = 0; i < iterations && refused < 3; ++i)
  {
    Eigen::VectorXd step;
    if (!this->FindStep(candidate, step, damping))
    {
      return;
    }
    VolumeCandidate there = candidate;
    there.pose = candidate.pose.Moved(step.head<RigidPose::Steps>());
    there.coefficients += step.tail(there.coefficients.size());
    this->Correlate(there);
    const double gain = Merit(there) - Merit(candidate);
    if (gain > 0.0)
    {
      candidate = there;
      damping *= 0.3;
      refused = gain > 0.01 ? 0 : refused + 1;
    }
    else
    {
      damping = std::max(1.0, 10.0 * damping);
      ++refused;
    }
  }
}
} // namespace bone
