/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshRepair.h"

#include "bonePredicates.h"
#include "boneQualityMeasures.h"

#include <algorithm>

namespace bone
{
namespace
{
constexpr double Gain = 1e-4;
} // namespace

MeshRepair::MeshRepair(TetraComplex & complex, PointMover & mover, const SurfaceTarget & first, double distanceBound)
  : m_Complex(complex)
  , m_Mover(mover)
  , m_First(first)
  , m_SquaredBound(distanceBound * distanceBound)
{}

std::size_t
MeshRepair::Run(double limit, const std::function<void(const std::vector<IdType> &)> & changed)
{
  std::vector<std::pair<double, IdType>> worst;
  for (IdType t = 0; t < m_Complex.Size(); ++t)
  {
    const double cosine = m_Complex.IsAlive(t) ? CellCosine(m_Complex, t) : -1.0;
    if (cosine > limit)
    {
      worst.emplace_back(-cosine, t);
    }
  }
  std::sort(worst.begin(), worst.end());
  std::size_t         count = 0;
  std::vector<IdType> cells;
  for (const auto & candidate : worst)
  {
    const IdType t = candidate.second;
    if (!m_Complex.IsAlive(t) || !(CellCosine(m_Complex, t) > limit))
    {
      continue;
    }
    cells.clear();
    if (FlipSurface(t, cells) || CollapseAt(t, cells))
    {
      ++count;
      changed(cells);
    }
  }
  return count;
}

bool
MeshRepair::IsNear(int surface, const std::array<Vector3, 3> & triangle) const
{
  const auto & [a, b, c] = triangle;
  return m_First.SquaredDistance(surface, (a + b + c) / 3.0) <= m_SquaredBound &&
         m_First.SquaredDistance(surface, (a + b) / 2.0) <= m_SquaredBound &&
         m_First.SquaredDistance(surface, (b + c) / 2.0) <= m_SquaredBound &&
         m_First.SquaredDistance(surface, (c + a) / 2.0) <= m_SquaredBound;
}

bool
MeshRepair::FlipSurface(IdType t, std::vector<IdType> & changed)
{
  const auto & p = m_Complex.Points();
  const Id4    cell = m_Complex.Cell(t);
  for (const auto & edge : TetraEdges)
  {
    const IdType a = cell[edge[0]], b = cell[edge[1]];
    if (m_Complex.Dimension(a) == 3 || m_Complex.Dimension(b) == 3)
    {
      continue;
    }
    const SurfaceFlip plan = PlanSurfaceFlip(m_Complex, a, b);
    if (plan.outcome != MeshOperation::Done)
    {
      continue;
    }
    const auto [c, d] = plan.corners;
    const Vector3 middle = (p[a] + p[b]) / 2.0;
    const bool    covered =
      std::min((ClosestPointOnTriangle(middle, p[a], p[c], p[d]) - middle).squaredNorm(),
               (ClosestPointOnTriangle(middle, p[b], p[c], p[d]) - middle).squaredNorm()) <= m_SquaredBound;
    if (!covered || !IsNear(plan.surface, { p[a], p[c], p[d] }) || !IsNear(plan.surface, { p[b], p[c], p[d] }))
    {
      continue;
    }
    if (m_Mover.IsTested(plan.surface) &&
        !m_Mover.ReplaceBoundary({ { a, b, c }, { a, b, d } }, { { a, c, d }, { b, c, d } }))
    {
      continue;
    }
    changed = m_Complex.ReplaceAcross(plan.removed, plan.created, plan.regions, plan.surface);
    return true;
  }
  return false;
}

double
MeshRepair::WorstAfterCollapse(IdType v, IdType w) const
{
  const auto & p = m_Complex.Points();
  double       worst = -1.0;
  for (IdType t : m_Complex.Star(v))
  {
    Id4 c = m_Complex.Cell(t);
    if (m_Complex.Has(t, w))
    {
      continue;
    }
    c[m_Complex.LocalIndex(t, v)] = w;
    if (!(SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) > 0))
    {
      return 2.0;
    }
    worst = std::max(worst, LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]));
  }
  return worst;
}

bool
MeshRepair::CollapseKeepsSurfaces(IdType                     v,
                                  IdType                     w,
                                  std::vector<TriangleIds> & removed,
                                  std::vector<TriangleIds> & added) const
{
  if (m_Complex.Dimension(v) == 3)
  {
    return true;
  }
  const auto &                           p = m_Complex.Points();
  std::vector<TetraComplex::SurfaceFace> faces;
  m_Complex.SurfaceStar(v, faces);
  std::vector<std::pair<int, double>> nearest; // of v to the new triangles of each surface
  for (const auto & face : faces)
  {
    const bool tested = m_Mover.IsTested(face.surface);
    if (tested)
    {
      removed.push_back({ v, face.a, face.b });
    }
    auto at = std::find_if(nearest.begin(), nearest.end(), [&](const auto & n) { return n.first == face.surface; });
    if (at == nearest.end())
    {
      at = nearest.insert(nearest.end(), { face.surface, (p[v] - p[w]).squaredNorm() });
    }
    if (face.a == w || face.b == w)
    {
      continue;
    }
    if (tested)
    {
      added.push_back({ w, face.a, face.b });
    }
    at->second = std::min(at->second, (ClosestPointOnTriangle(p[v], p[w], p[face.a], p[face.b]) - p[v]).squaredNorm());
    // A triangle that turns by more than a right angle folds the surface.
    const Vector3 before = (p[face.a] - p[v]).cross(p[face.b] - p[v]);
    const Vector3 after = (p[face.a] - p[w]).cross(p[face.b] - p[w]);
    if (!(before.dot(after) > 0) || !IsNear(face.surface, { p[w], p[face.a], p[face.b] }))
    {
      return false;
    }
  }
  if (std::any_of(nearest.begin(), nearest.end(), [this](const auto & n) { return n.second > m_SquaredBound; }))
  {
    return false;
  }
  if (m_Complex.Dimension(v) == 1)
  {
    const auto & curve = m_Complex.Surfaces().curve[v];
    const IdType x = curve[0] == w ? curve[1] : curve[0];
    return (ClosestPointOnSegment(p[v], p[w], p[x]) - p[v]).squaredNorm() <= m_SquaredBound;
  }
  return true;
}

bool
MeshRepair::TryCollapse(IdType v, IdType w, double cosine, std::vector<IdType> & changed)
{
  if (!(WorstAfterCollapse(v, w) < cosine) || m_Complex.CanCollapse(v, w) != MeshOperation::Done)
  {
    return false;
  }
  const auto & p = m_Complex.Points();
  for (IdType t : m_Complex.Star(v))
  {
    Id4 c = m_Complex.Cell(t);
    c[m_Complex.LocalIndex(t, v)] = w;
    if (!m_Complex.Has(t, w) && Orient3D(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) <= 0)
    {
      return false;
    }
  }
  std::vector<TriangleIds> removed, added;
  if (!CollapseKeepsSurfaces(v, w, removed, added) || !m_Mover.ReplaceBoundary(removed, added))
  {
    return false;
  }
  changed = m_Complex.Collapse(v, w);
  return true;
}

bool
MeshRepair::CollapseAt(IdType t, std::vector<IdType> & changed)
{
  struct Candidate
  {
    double worst;
    IdType v;
    IdType w;
    double limit;
  };
  std::vector<Candidate> candidates;
  for (IdType v : m_Complex.Cell(t))
  {
    if (m_Complex.Dimension(v) == 0)
    {
      continue;
    }
    const double limit = m_Mover.WorstCosine(v) - Gain;
    for (IdType w : m_Complex.PointNeighbors(v))
    {
      if (m_Complex.Dimension(v) == 3 || m_Complex.Dimension(w) <= m_Complex.Dimension(v))
      {
        const double worst = WorstAfterCollapse(v, w);
        if (worst < limit)
        {
          candidates.push_back({ worst, v, w, limit });
        }
      }
    }
  }
  std::stable_sort(
    candidates.begin(), candidates.end(), [](const Candidate & a, const Candidate & b) { return a.worst < b.worst; });
  return std::any_of(candidates.begin(), candidates.end(), [&](const Candidate & candidate) {
    return TryCollapse(candidate.v, candidate.w, candidate.limit, changed);
  });
}
} // namespace bone
