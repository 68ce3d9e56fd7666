/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceBound.h"

#include <algorithm>
#include <limits>

namespace bone
{
namespace
{
constexpr double Far = std::numeric_limits<double>::max();
} // namespace

SurfaceBound::SurfaceBound(const TetraComplex & complex, const SurfaceTarget & first, double bound)
  : m_First(first)
  , m_SquaredBound(bound * bound)
  , m_SquaredLeast(bound * bound)
  , m_At(complex.Points().size())
{
  const auto &      points = complex.Points();
  std::vector<char> seen(points.size(), 0);
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      if (!complex.Carries(t, i))
      {
        continue;
      }
      const Id4 &       c = complex.Cell(t);
      const TriangleIds ids = { c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] };
      const Vector3     sum = points[ids[0]] + points[ids[1]] + points[ids[2]];
      const TriangleIds owner = Ascending(ids);
      const int         surface = complex.FaceSurfaces(t)[i];
      AddSample(sum / 3.0, owner, surface);
      for (IdType p : ids)
      {
        AddSample((sum + 3.0 * points[p]) / 6.0, owner, surface);
        if (!seen[p])
        {
          seen[p] = 1;
          AddSample(points[p], owner, surface);
        }
      }
    }
  }
}

void
SurfaceBound::AddSample(const Vector3 & place, const TriangleIds & owner, int surface)
{
  m_At[owner[0]].push_back(static_cast<int>(m_Samples.size()));
  m_Samples.push_back({ place, owner, 0.0, surface });
}

double
SurfaceBound::SquaredDistance(const Sample & sample, const TriangleIds & t, const std::vector<Vector3> & points)
{
  return (ClosestPointOnTriangle(sample.place, points[t[0]], points[t[1]], points[t[2]]) - sample.place).squaredNorm();
}

bool
SurfaceBound::FindOwners(const std::vector<SurfaceTriangle> & removed,
                         const std::vector<SurfaceTriangle> & added,
                         const std::vector<Vector3> &         points)
{
  m_Visits.clear();
  m_Farthest = m_SquaredBound;
  const bool   moved = removed.empty();
  const auto & goes = moved ? added : removed;
  for (std::size_t r = 0; r < goes.size(); ++r)
  {
    const TriangleIds key = Ascending(goes[r].ids);
    for (int s : m_At[key[0]])
    {
      const Sample & sample = m_Samples[s];
      if (sample.owner != key)
      {
        continue;
      }
      // Most samples stay close to their triangle where it moves: the others are not looked at then.
      Visit visit{ s, static_cast<int>(r), moved ? SquaredDistance(sample, goes[r].ids, points) : Far };
      if (visit.squaredDistance <= m_SquaredLeast)
      {
        m_Visits.push_back(visit);
        continue;
      }
      const double allowed = std::max(m_SquaredBound, sample.squaredDistance);
      for (std::size_t k = 0; k < added.size(); ++k)
      {
        if (added[k].surface == sample.surface)
        {
          const double squared = SquaredDistance(sample, added[k].ids, points);
          if (squared < visit.squaredDistance)
          {
            visit.squaredDistance = squared;
            visit.triangle = static_cast<int>(k);
          }
        }
      }
      if (!(visit.squaredDistance <= allowed))
      {
        return false;
      }
      m_Farthest = std::max(m_Farthest, sample.squaredDistance);
      m_Visits.push_back(visit);
    }
  }
  return true;
}

bool
SurfaceBound::Replace(const std::vector<SurfaceTriangle> & removed,
                      const std::vector<SurfaceTriangle> & added,
                      const std::vector<Vector3> &         points)
{
  if (!FindOwners(removed, added, points))
  {
    return false;
  }
  for (const SurfaceTriangle & triangle : added)
  {
    const Vector3 sum = points[triangle.ids[0]] + points[triangle.ids[1]] + points[triangle.ids[2]];
    if (!m_First.IsWithin(triangle.surface, sum / 3.0, m_Farthest))
    {
      return false;
    }
  }
  for (const SurfaceTriangle & old : removed)
  {
    const TriangleIds key = Ascending(old.ids);
    auto &            at = m_At[key[0]];
    at.erase(std::remove_if(at.begin(), at.end(), [&](int s) { return m_Samples[s].owner == key; }), at.end());
  }
  for (const Visit & visit : m_Visits)
  {
    Sample & sample = m_Samples[visit.sample];
    sample.squaredDistance = visit.squaredDistance;
    const TriangleIds owner = Ascending(added[visit.triangle].ids);
    if (!removed.empty())
    {
      m_At[owner[0]].push_back(visit.sample);
      sample.owner = owner;
    }
    else if (sample.owner != owner)
    {
      auto & at = m_At[sample.owner[0]];
      at.erase(std::find(at.begin(), at.end(), visit.sample));
      m_At[owner[0]].push_back(visit.sample);
      sample.owner = owner;
    }
  }
  return true;
}
} // namespace bone
