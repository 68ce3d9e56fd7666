/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVolumeKeeper.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace bone
{
namespace
{
constexpr int    Steps = 4;
constexpr double Tolerance = 2e-4; // of a volume

/** Area normals of a surface at its points: outward from what it encloses. */
struct Level
{
  std::vector<IdType>  points;
  std::vector<Vector3> normals; // of length one third of the area around the point
  double               area{ 0.0 };
};

/** The surface of all regions of at least `region`. */
Level
FindLevel(const TetraComplex & complex, int region)
{
  std::map<IdType, Vector3> normals;
  const auto &              x = complex.Points();
  const auto &              surfaces = complex.Surfaces().surfaces;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t) && complex.Region(t) >= region; ++i)
    {
      const int    s = complex.FaceSurfaces(t)[i];
      const IdType n = complex.Neighbors(t)[i];
      if (s < 0 || (n >= 0 && complex.Region(n) >= region) || surfaces[s].flat >= 0)
      {
        continue;
      }
      const Id4 &   c = complex.Cell(t);
      const IdType  f[3] = { c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] };
      const Vector3 normal = (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]) / 6.0;
      for (IdType p : f)
      {
        if (complex.Dimension(p) == 2)
        {
          normals.emplace(p, Vector3::Zero()).first->second += normal;
        }
      }
    }
  }
  Level level;
  for (const auto & [p, normal] : normals)
  {
    level.points.push_back(p);
    level.normals.push_back(normal);
    level.area += normal.norm();
  }
  return level;
}
} // namespace

VolumeKeeper::VolumeKeeper(const TetraComplex & complex)
  : m_Volumes(VolumesWithin(complex))
{}

std::map<int, double>
VolumeKeeper::VolumesWithin(const TetraComplex & complex)
{
  std::map<int, double> volumes;
  const auto &          x = complex.Points();
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    if (complex.IsAlive(t))
    {
      const Id4 & c = complex.Cell(t);
      volumes[complex.Region(t)] += SignedVolume(x[c[0]], x[c[1]], x[c[2]], x[c[3]]);
    }
  }
  double sum = 0.0;
  for (auto at = volumes.rbegin(); at != volumes.rend(); ++at)
  {
    sum += at->second;
    at->second = sum;
  }
  return volumes;
}

void
VolumeKeeper::Restore(TetraComplex & complex, PointMover & mover, const Parameters & parameters) const
{
  // Of the smaller one of the regions beside each surface.
  std::map<int, double> slack;
  double                outer = std::numeric_limits<double>::max();
  for (auto at = m_Volumes.begin(); at != m_Volumes.end(); ++at)
  {
    const auto   next = std::next(at);
    const double inner = at->second - (next == m_Volumes.end() ? 0.0 : next->second);
    slack[at->first] = parameters.slack * std::min(outer, inner);
    outer = inner;
  }
  for (int step = 0; step < Steps; ++step)
  {
    const std::map<int, double> now = VolumesWithin(complex);
    for (const auto & [region, volume] : m_Volumes)
    {
      const auto   found = now.find(region);
      const double present = found == now.end() ? 0.0 : found->second;
      const double missing = std::clamp(present, volume - slack[region], volume + slack[region]) - present;
      if (std::abs(missing) < Tolerance * volume)
      {
        continue;
      }
      const Level level = FindLevel(complex, region);
      if (!(level.area > 0))
      {
        continue;
      }
      for (std::size_t i = 0; i < level.points.size(); ++i)
      {
        const IdType  p = level.points[i];
        const double  length = level.normals[i].norm();
        const Vector3 shift = level.normals[i] * (missing / level.area / (length > 0 ? length : 1.0));
        const Vector3 x = complex.Points()[p] + shift;
        if (!parameters.limit || parameters.limit(p, x))
        {
          mover.TryMove(p, x, parameters.cosineFloor);
        }
      }
    }
  }
}
} // namespace bone
