/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBoundaryFit.h"

#include "boneSparseCholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr int    reach = 4;         // samples to each side of an edge that tell its height
constexpr double leastFall = 80.0;  // HU
constexpr double clearFall = 300.0; // HU
constexpr double wideFall = 400.0;  // HU: even to a gap of less than a voxel
constexpr double beyondAnother = 0.4;

double
MedianOf(std::vector<double> values)
{
  if (values.empty())
  {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/** Along a profile, mm: at least two samples a voxel. */
double
SampleStep(const VoxelGrid & grid)
{
  constexpr double least = 0.5, ofVoxel = 1.0 / 3.0;
  return std::max(least, ofVoxel * grid.axes.colwise().norm().maxCoeff());
}

/** Samples, smoothed over three of them; as many as lie in the image, from the inside on. */
std::vector<double>
Profile(const VolumeView & ct, const Vector3 & x, const Vector3 & outward, double sampleStep, int half)
{
  std::vector<double> raw;
  for (int i = -half; i <= half; ++i)
  {
    double value;
    if (!ct.Sample(x + sampleStep * i * outward, value))
    {
      break;
    }
    raw.push_back(value);
  }
  std::vector<double> smooth = raw;
  for (std::size_t i = 1; i + 1 < raw.size(); ++i)
  {
    smooth[i] = 0.25 * raw[i - 1] + 0.5 * raw[i] + 0.25 * raw[i + 1];
  }
  return smooth;
}
} // namespace

BoundaryTarget
FindBoundary(const VolumeView & ct, const Vector3 & x, const Vector3 & outward, double range, double boneThreshold)
{
  BoundaryTarget target;
  double         value;
  if (!ct.Sample(x, value))
  {
    return target;
  }
  target.visible = true;
  const double              sampleStep = SampleStep(ct.grid);
  const int                 half = static_cast<int>(range / sampleStep) + reach + 1;
  const std::vector<double> v = Profile(ct, x, outward, sampleStep, half);
  double                    best = 0.0;
  bool                      left = false; // an edge further inside led out of a bone: what follows may be a neighbour's
  for (int i = reach; i + reach < static_cast<int>(v.size()); ++i)
  {
    const double fall = v[i - 1] - v[i + 1];
    if (!(fall > 0.0 && fall >= v[i - 2] - v[i] && fall > v[i] - v[i + 2]))
    {
      continue;
    }
    const double high = *std::max_element(v.begin() + i - reach, v.begin() + i + 1);
    const double low = *std::min_element(v.begin() + i, v.begin() + i + reach + 1);
    if (high < boneThreshold || high - low < leastFall)
    {
      continue;
    }
    // Where the profile comes through the middle, near the steepest place.
    const double middle = 0.5 * (high + low);
    int          at = i;
    while (at > i - reach && v[at] < middle)
    {
      --at;
    }
    while (at < i + reach && v[at + 1] > middle)
    {
      ++at;
    }
    const double between = (v[at] - middle) / std::max(v[at] - v[at + 1], 1e-9);
    const double offset = (at - half + std::clamp(between, 0.0, 1.0)) * sampleStep;
    const double weight = std::min(1.0, (high - low) / clearFall);
    const double merit = weight * (1.0 - 0.7 * offset * offset / (range * range)) * (left ? beyondAnother : 1.0);
    left = left || low < boneThreshold || high - low > wideFall;
    if (std::abs(offset) <= range && merit > best)
    {
      best = merit;
      target.offset = offset;
      target.weight = weight;
    }
  }
  return target;
}

BoundaryFit::BoundaryFit(const DeformableModel & model, const VolumeView & ct, double boneThreshold)
  : m_Model(model)
  , m_Image(ct)
  , m_BoneThreshold(boneThreshold)
{
  MeshArrays mean = model.mean;
  if (mean.neighbors.empty())
  {
    mean.neighbors = ComputeFaceNeighbors(mean.tetrahedra);
  }
  m_Surface = ExteriorSurface(mean, m_Exterior);
  m_Neighbors.resize(m_Exterior.size());
  for (const auto & triangle : m_Surface.triangles)
  {
    for (std::size_t k = 0; k < 3; ++k)
    {
      m_Neighbors[static_cast<std::size_t>(triangle[k])].push_back(static_cast<std::size_t>(triangle[(k + 1) % 3]));
    }
  }
}

std::vector<Vector3>
BoundaryFit::Points(const VolumeState & state) const
{
  std::vector<Vector3> points;
  points.reserve(m_Exterior.size());
  for (const IdType p : m_Exterior)
  {
    Vector3 x = m_Model.mean.points[static_cast<std::size_t>(p)];
    for (Eigen::Index k = 0; k < state.coefficients.size(); ++k)
    {
      x += state.coefficients[k] * m_Model.displacements[static_cast<std::size_t>(k)][static_cast<std::size_t>(p)];
    }
    points.push_back(state.pose.Apply(x));
  }
  return points;
}

std::vector<BoundaryTarget>
BoundaryFit::FindTargets(const std::vector<Vector3> & points,
                         double                       range,
                         std::vector<Vector3> &       normals,
                         const Execution &            execution) const
{
  TriangleSurface surface{ points, m_Surface.triangles };
  normals = PointNormals(surface);
  std::vector<BoundaryTarget> targets(points.size());
  execution.Silent().For(
    points.size(),
    [&](std::size_t i) { targets[i] = FindBoundary(m_Image, points[i], normals[i], range, m_BoneThreshold); },
    64);
  return targets;
}

void
BoundaryFit::Step(VolumeState & state, double range, Eigen::Index modes, const Execution & execution)
{
  constexpr double                  leastDeviation = 0.25; // mm
  constexpr double                  alike = 3.0;           // neighbouring distances that count as one
  std::vector<Vector3>              normals;
  const std::vector<Vector3>        points = this->Points(state);
  const std::vector<BoundaryTarget> targets = this->FindTargets(points, range, normals, execution);
  std::vector<double>               sizes;
  for (const BoundaryTarget & target : targets)
  {
    if (target.weight > 0.0)
    {
      sizes.push_back(std::abs(target.offset));
    }
  }
  const double       deviation = std::max(leastDeviation, 1.4826 * MedianOf(sizes));
  const double       limit = std::max(4.685 * deviation, 1.0);
  const Eigen::Index columns = RigidPose::Steps + modes;
  Eigen::MatrixXd    jacobian(static_cast<Eigen::Index>(points.size()), columns);
  Eigen::VectorXd    offsets = Eigen::VectorXd::Zero(jacobian.rows());
  execution.Silent().For(
    points.size(),
    [&](std::size_t i) {
      const auto row = static_cast<Eigen::Index>(i);
      const auto u = targets[i].offset / limit;
      if (targets[i].weight == 0.0 || std::abs(u) >= 1.0)
      {
        jacobian.row(row).setZero();
        return;
      }
      const double  tukey = 1.0 - u * u;
      const double  root = std::sqrt(targets[i].weight / alike) * tukey / deviation;
      const Vector3 n = state.pose.rotation.transpose() * normals[i];
      const Vector3 q = state.pose.ApplyInverse(points[i]) - state.pose.centre;
      const auto    p = static_cast<std::size_t>(m_Exterior[i]);
      jacobian.row(row).head<3>() = root * n;
      jacobian.row(row).segment<3>(3) = root * q.cross(n);
      for (Eigen::Index k = 0; k < modes; ++k)
      {
        jacobian(row, RigidPose::Steps + k) = root * n.dot(m_Model.displacements[static_cast<std::size_t>(k)][p]);
      }
      offsets[row] = root * targets[i].offset;
    },
    64);
  m_Hessian = Eigen::MatrixXd::Zero(columns, columns);
  m_Hessian.selfadjointView<Eigen::Lower>().rankUpdate(jacobian.transpose());
  m_Hessian.triangularView<Eigen::StrictlyUpper>() = m_Hessian.transpose();
  m_Hessian.diagonal().tail(modes).array() += 1.0;
  m_Hessian.diagonal().head<RigidPose::Steps>().array() += 1e-6;
  Eigen::VectorXd slope = jacobian.transpose() * offsets;
  slope.tail(modes) -= state.coefficients.head(modes);
  const Eigen::VectorXd step = m_Hessian.ldlt().solve(slope);
  state.pose = state.pose.Moved(step.head<RigidPose::Steps>());
  state.coefficients.head(modes) += step.tail(modes);
}

std::vector<Vector3>
BoundaryFit::Settle(std::vector<Vector3> points, double range, const Execution & execution) const
{
  constexpr double                  stiffness = 1.0;
  constexpr double                  hold = 0.01;
  constexpr double                  limit = 1.0; // mm
  constexpr int                     rounds = 3;
  std::vector<Vector3>              normals;
  const std::vector<BoundaryTarget> targets = this->FindTargets(points, range, normals, execution);
  Eigen::MatrixXd                   offsets = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(points.size()), 1);
  for (int round = 0; round < rounds; ++round)
  {
    std::vector<SparseEntry> entries;
    Eigen::MatrixXd          right = Eigen::MatrixXd::Zero(offsets.rows(), 1);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      const auto   row = static_cast<Eigen::Index>(i);
      const double u = round == 0 ? 0.0 : std::min(1.0, std::abs(targets[i].offset - offsets(row, 0)) / limit);
      const double weight = targets[i].weight * (1.0 - u * u) * (1.0 - u * u);
      entries.push_back({ row, row, weight + hold });
      right(row, 0) = weight * targets[i].offset;
      // Half the sum of squared differences from the mean of the neighbours.
      const auto &                                 neighbors = m_Neighbors[i];
      std::vector<std::pair<Eigen::Index, double>> terms{ { row, 1.0 } };
      for (const std::size_t j : neighbors)
      {
        terms.emplace_back(static_cast<Eigen::Index>(j), -1.0 / static_cast<double>(neighbors.size()));
      }
      for (const auto & [a, x] : terms)
      {
        for (const auto & [b, y] : terms)
        {
          if (a >= b)
          {
            entries.push_back({ a, b, stiffness * x * y });
          }
        }
      }
    }
    SparseCholesky solver;
    if (!solver.Factorize(offsets.rows(), entries))
    {
      return points;
    }
    offsets = solver.Solve(right);
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    points[i] += offsets(static_cast<Eigen::Index>(i), 0) * normals[i];
  }
  return points;
}

BoundarySupport
BoundaryFit::Judge(const std::vector<Vector3> &    points,
                   const Execution &               execution,
                   std::vector<UnsupportedPatch> * unsupported) const
{
  constexpr double                  range = 5.0; // mm
  std::vector<Vector3>              normals;
  const std::vector<BoundaryTarget> targets = this->FindTargets(points, range, normals, execution);
  BoundarySupport                   support;
  std::vector<double>               sizes;
  std::vector<bool>                 left(targets.size());
  double                            visible = 0.0;
  for (std::size_t i = 0; i < targets.size(); ++i)
  {
    const BoundaryTarget & target = targets[i];
    const bool             near = target.weight > 0.0 && std::abs(target.offset) < Near;
    visible += target.visible ? 1.0 : 0.0;
    support.supported += near ? 1.0 : 0.0;
    left[i] = target.visible && !near;
    if (target.weight > 0.0)
    {
      sizes.push_back(std::abs(target.offset));
    }
  }
  support.visible = visible / static_cast<double>(targets.size());
  support.supported /= std::max(visible, 1.0);
  support.residual = MedianOf(sizes);
  if (unsupported != nullptr)
  {
    *unsupported = this->FindPatches(points, left, visible);
  }
  return support;
}

std::vector<UnsupportedPatch>
BoundaryFit::FindPatches(const std::vector<Vector3> & points, std::vector<bool> left, double visible) const
{
  constexpr std::size_t         least = 5; // points
  std::vector<UnsupportedPatch> patches;
  for (std::size_t first = 0; first < left.size(); ++first)
  {
    std::vector<std::size_t> part;
    if (left[first])
    {
      part.push_back(first);
      left[first] = false;
    }
    for (std::size_t i = 0; i < part.size(); ++i)
    {
      for (const std::size_t j : m_Neighbors[part[i]])
      {
        if (left[j])
        {
          left[j] = false;
          part.push_back(j);
        }
      }
    }
    if (part.size() < least)
    {
      continue;
    }
    UnsupportedPatch patch;
    patch.share = static_cast<double>(part.size()) / visible;
    for (const std::size_t i : part)
    {
      patch.centre += points[i] / static_cast<double>(part.size());
    }
    for (const std::size_t i : part)
    {
      patch.extent = std::max(patch.extent, (points[i] - patch.centre).norm());
    }
    patches.push_back(patch);
  }
  std::stable_sort(patches.begin(), patches.end(), [](const UnsupportedPatch & a, const UnsupportedPatch & b) {
    return a.share > b.share;
  });
  return patches;
}
} // namespace bone
