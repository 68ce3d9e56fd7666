/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceAlignment.h"

#include "boneAcrossFit.h"
#include "boneSymmetricEigen.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr double      Convergence = 1e-3; // change of the root mean square distance, relative
constexpr int         FlipSamples = 400;
constexpr int         FlipIterations = 30;
constexpr std::size_t SamplesAtOnce = 64; // samples that a thread takes at once

struct Sample
{
  Vector3 point;
  Vector3 normal;
};

/** Evenly spread points: one in the middle of each share of area, along the order of triangles. */
std::vector<Sample>
SampleSurface(const TriangleSurface & surface, int count)
{
  std::vector<double> area;
  double              sum = 0;
  for (const auto & t : surface.triangles)
  {
    const Vector3 & a = surface.points[t[0]];
    sum += 0.5 * (surface.points[t[1]] - a).cross(surface.points[t[2]] - a).norm();
    area.push_back(sum);
  }
  if (!(sum > 0))
  {
    throw std::invalid_argument("A surface to align has no area.");
  }
  std::vector<Sample> samples;
  for (int s = 0; s < count; ++s)
  {
    const auto    found = std::lower_bound(area.begin(), area.end(), sum * (s + 0.5) / count);
    const auto &  t = surface.triangles[static_cast<std::size_t>(found - area.begin())];
    const Vector3 a = surface.points[t[0]], b = surface.points[t[1]], c = surface.points[t[2]];
    samples.push_back({ (a + b + c) / 3.0, (b - a).cross(c - a).normalized() });
  }
  return samples;
}

struct Axes
{
  Vector3         centre;
  Eigen::Matrix3d axes; // columns, right-handed
};

Axes
PrincipalAxes(const TriangleSurface & surface)
{
  double          sum = 0;
  Vector3         centre = Vector3::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  const Vector3   origin = surface.points.front();
  for (const auto & t : surface.triangles)
  {
    const Vector3 a = surface.points[t[0]] - origin, b = surface.points[t[1]] - origin,
                  c = surface.points[t[2]] - origin;
    const double  area = 0.5 * (b - a).cross(c - a).norm();
    const Vector3 m = a + b + c;
    sum += area;
    centre += area / 3.0 * m;
    moment += area / 12.0 * (m * m.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  centre /= sum;
  moment = moment / sum - centre * centre.transpose();
  Eigen::Matrix3d axes = EigenOf(moment).vectors;
  if (axes.determinant() < 0)
  {
    axes.col(0) = -axes.col(0);
  }
  return { centre + origin, axes };
}

/** The affine map that brings points to planes through `to`; along the planes they are held by a tenth of the force,
 * so that a surface may slide along itself and few iterations are needed. */
AffineMap
FitAcross(const std::vector<Vector3> & from, const std::vector<Vector3> & to, const std::vector<Vector3> & normals)
{
  constexpr double Along = 0.1;
  Vector3          centre = Vector3::Zero();
  for (const Vector3 & x : from)
  {
    centre += x / static_cast<double>(from.size());
  }
  AcrossFit fit;
  for (std::size_t i = 0; i < from.size(); ++i)
  {
    fit.Add(from[i] - centre, AcrossFit::MakeTerm(normals[i], to[i] - centre, Along, 1.0), 1.0);
  }
  AffineMap map;
  Vector3   place;
  if (!fit.Solve(0.0, map.linear, place))
  {
    return FitAlignment(from, to, AlignmentKind::Affine);
  }
  map.translation = centre + place - map.linear * centre;
  return map;
}

/** One run of closest points. */
class ClosestPoints
{
public:
  ClosestPoints(const DirectedSurface & source,
                const DirectedSurface & target,
                int                     samples,
                double                  trim,
                const Execution &       execution)
    : m_Source(source)
    , m_Target(target)
    , m_SourceSamples(SampleSurface(source.GetSurface(), samples))
    , m_TargetSamples(SampleSurface(target.GetSurface(), samples))
    , m_Trim(trim)
    , m_Execution(execution)
  {}

  /** Improves the map; returns the root mean square distance of the pairs that count. */
  double
  Run(AffineMap & map, AlignmentKind kind, int iterations) const
  {
    double before = std::numeric_limits<double>::max();
    for (int i = 0; i < iterations; ++i)
    {
      std::vector<Vector3> from, to, normals;
      const double         distance = this->Pair(map, from, to, normals);
      map = kind == AlignmentKind::Affine ? FitAcross(from, to, normals) : FitAlignment(from, to, kind);
      if (std::abs(before - distance) < Convergence * distance)
      {
        return distance;
      }
      before = distance;
    }
    return before;
  }

private:
  double
  Pair(const AffineMap &      map,
       std::vector<Vector3> & from,
       std::vector<Vector3> & to,
       std::vector<Vector3> & normals) const
  {
    struct Candidate
    {
      double  squaredDistance{ -1.0 };
      Vector3 from{ Vector3::Zero() };
      Vector3 to{ Vector3::Zero() };
      Vector3 normal{ Vector3::Zero() }; // of the target
    };
    const AffineMap back = map.Inverse();
    // Normals go by the inverse transpose.
    const Eigen::Matrix3d  forward = back.linear.transpose(), backward = map.linear.transpose();
    std::vector<Candidate> found(m_SourceSamples.size() + m_TargetSamples.size(), Candidate());
    m_Execution.Silent().For(
      m_SourceSamples.size(),
      [&](std::size_t i) {
        const Sample & s = m_SourceSamples[i];
        const auto     match = m_Target.Find(map(s.point), forward * s.normal);
        if (match.triangle >= 0)
        {
          found[i] = { match.squaredDistance, s.point, match.point, m_Target.NormalAt(match.triangle, match.point) };
        }
      },
      SamplesAtOnce);
    m_Execution.Silent().For(
      m_TargetSamples.size(),
      [&](std::size_t i) {
        const Sample & s = m_TargetSamples[i];
        const auto     match = m_Source.Find(back(s.point), backward * s.normal);
        if (match.triangle >= 0)
        {
          const double squared = (map(match.point) - s.point).squaredNorm();
          found[m_SourceSamples.size() + i] = { squared, match.point, s.point, s.normal };
        }
      },
      SamplesAtOnce);
    std::vector<Candidate> pairs;
    std::copy_if(found.begin(), found.end(), std::back_inserter(pairs), [](const Candidate & c) {
      return c.squaredDistance >= 0;
    });
    std::stable_sort(pairs.begin(), pairs.end(), [](const Candidate & a, const Candidate & b) {
      return a.squaredDistance < b.squaredDistance;
    });
    pairs.resize(std::max<std::size_t>(4, static_cast<std::size_t>(m_Trim * static_cast<double>(pairs.size()))));
    double sum = 0;
    for (const Candidate & pair : pairs)
    {
      sum += pair.squaredDistance;
      from.push_back(pair.from);
      to.push_back(pair.to);
      normals.push_back(pair.normal);
    }
    return std::sqrt(sum / static_cast<double>(pairs.size()));
  }

  const DirectedSurface & m_Source;
  const DirectedSurface & m_Target;
  std::vector<Sample>     m_SourceSamples;
  std::vector<Sample>     m_TargetSamples;
  double                  m_Trim;
  Execution               m_Execution;
};

/** Rigid maps that bring the principal axes onto each other. */
std::vector<AffineMap>
Flips(const TriangleSurface & source, const TriangleSurface & target)
{
  const Axes             from = PrincipalAxes(source), to = PrincipalAxes(target);
  std::vector<AffineMap> maps;
  for (const Vector3 & sign : { Vector3(1, 1, 1), Vector3(1, -1, -1), Vector3(-1, 1, -1), Vector3(-1, -1, 1) })
  {
    AffineMap map;
    map.linear = to.axes * sign.asDiagonal() * from.axes.transpose();
    map.translation = to.centre - map.linear * from.centre;
    maps.push_back(map);
  }
  return maps;
}
} // namespace

SurfaceAlignmentResult
AlignSurfaces(const TriangleSurface &            surface,
              const DirectedSurface &            target,
              const SurfaceAlignmentParameters & parameters,
              const Execution &                  execution)
{
  if (!(parameters.trim > 0 && parameters.trim <= 1) || parameters.samples < 10 || parameters.iterations < 1 ||
      surface.triangles.empty() || target.GetSurface().triangles.empty())
  {
    throw std::invalid_argument("An alignment of surfaces needs triangles on both, a trim above 0 and at most 1, ten "
                                "samples and one iteration or more.");
  }
  const DirectedSurface  source(surface);
  SurfaceAlignmentResult result;
  if (parameters.principalAxes)
  {
    const ClosestPoints coarse(source, target, std::min(FlipSamples, parameters.samples), parameters.trim, execution);
    double              best = std::numeric_limits<double>::max();
    for (AffineMap map : Flips(surface, target.GetSurface()))
    {
      execution.Report(0.1);
      const double distance = coarse.Run(map, AlignmentKind::Rigid, FlipIterations);
      if (distance < best)
      {
        best = distance;
        result.map = map;
      }
    }
  }
  const ClosestPoints fine(source, target, parameters.samples, parameters.trim, execution);
  for (const AlignmentKind kind : { AlignmentKind::Rigid, AlignmentKind::Similarity, AlignmentKind::Affine })
  {
    if (kind <= parameters.kind)
    {
      result.distance = fine.Run(result.map, kind, parameters.iterations);
      execution.Report(0.2 + 0.25 * static_cast<double>(kind));
    }
  }
  return result;
}
} // namespace bone
