/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshRepair.h"

#include "bonePredicates.h"
#include "boneQualityMeasures.h"

#include <algorithm>
#include <tuple>

namespace bone
{
namespace
{
constexpr double Gain = 1e-4;
} // namespace

MeshRepair::MeshRepair(TetraComplex & complex, PointMover & mover, double distanceBound)
  : m_Complex(complex)
  , m_Mover(mover)
  , m_SquaredBound(distanceBound * distanceBound)
{}

std::size_t
MeshRepair::Run(double limit, const std::function<void(const std::vector<IdType> &)> & changed)
{
  std::size_t         count = 0;
  std::vector<IdType> cells;
  for (const auto & candidate : FindWorstCells(m_Complex, limit))
  {
    const IdType t = candidate.second;
    if (!m_Complex.IsAlive(t) || !(CellCosine(m_Complex, t) > limit) || IsRefused(t))
    {
      continue;
    }
    cells.clear();
    if (FlipSurface(t, cells) || CollapseAt(t, cells))
    {
      ++count;
      changed(cells);
      continue;
    }
    m_Refused.resize(m_Complex.Size(), 0);
    m_Refused[t] = m_Complex.Clock();
  }
  return count;
}

bool
MeshRepair::IsRefused(IdType t) const
{
  const std::uint32_t time = t < static_cast<IdType>(m_Refused.size()) ? m_Refused[t] : 0;
  const Id4 &         c = m_Complex.Cell(t);
  return time > 0 && std::none_of(c.begin(), c.end(), [&](IdType p) { return m_Complex.HasChanged(p, time); });
}

bool
MeshRepair::FlipSurface(IdType t, std::vector<IdType> & changed)
{
  const Id4 cell = m_Complex.Cell(t);
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
    const int f = plan.surface;
    if (!m_Mover.ReplaceSurface({ { { a, b, c }, f }, { { a, b, d }, f } }, { { { a, c, d }, f }, { { b, c, d }, f } }))
    {
      continue;
    }
    changed = m_Complex.ReplaceAcross(plan.removed, plan.created, plan.regions, plan.surface);
    return true;
  }
  return false;
}

double
MeshRepair::WorstAfterCollapse(IdType v, IdType w, double enough) const
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
    if (worst >= enough)
    {
      return worst;
    }
  }
  return worst;
}

bool
MeshRepair::CollapseKeepsSurfaces(IdType v, IdType w)
{
  if (m_Complex.Dimension(v) == 3)
  {
    return true;
  }
  const auto &                           p = m_Complex.Points();
  std::vector<TetraComplex::SurfaceFace> faces;
  std::vector<SurfaceTriangle>           removed, added;
  m_Complex.SurfaceStar(v, faces);
  for (const auto & face : faces)
  {
    removed.push_back({ { v, face.a, face.b }, face.surface });
    if (face.a == w || face.b == w)
    {
      continue;
    }
    added.push_back({ { w, face.a, face.b }, face.surface });
    // A triangle whose normal changes by more than a right angle folds the surface.
    const Vector3 before = (p[face.a] - p[v]).cross(p[face.b] - p[v]);
    const Vector3 after = (p[face.a] - p[w]).cross(p[face.b] - p[w]);
    if (!(before.dot(after) > 0))
    {
      return false;
    }
  }
  if (m_Complex.Dimension(v) == 1)
  {
    const auto & curve = m_Complex.Surfaces().curve[v];
    const IdType x = curve[0] == w ? curve[1] : curve[0];
    if (!((ClosestPointOnSegment(p[v], p[w], p[x]) - p[v]).squaredNorm() <= m_SquaredBound))
    {
      return false;
    }
  }
  return m_Mover.ReplaceSurface(removed, added);
}

bool
MeshRepair::TryCollapse(IdType v, IdType w, double cosine, std::vector<IdType> & changed)
{
  if (!(WorstAfterCollapse(v, w, cosine) < cosine) || m_Complex.CanCollapse(v, w) != MeshOperation::Done)
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
  if (!CollapseKeepsSurfaces(v, w))
  {
    return false;
  }
  changed = m_Complex.Collapse(v, w);
  return true;
}

std::size_t
MeshRepair::CollapseShort(double length)
{
  struct Edge
  {
    double length;
    IdType a;
    IdType b;

    bool
    operator<(const Edge & other) const
    {
      return std::tie(length, a, b) < std::tie(other.length, other.a, other.b);
    }
  };
  const auto & points = m_Complex.Points();
  std::size_t  count = 0;
  for (std::size_t before = count + 1; before != count;)
  {
    before = count;
    std::vector<Edge> edges;
    for (IdType a = 0; a < static_cast<IdType>(points.size()); ++a)
    {
      for (IdType b : m_Complex.Star(a).empty() ? std::vector<IdType>() : m_Complex.PointNeighbors(a))
      {
        const double along = (points[a] - points[b]).norm();
        if (a < b && along < length)
        {
          edges.push_back({ along, a, b });
        }
      }
    }
    std::sort(edges.begin(), edges.end());
    for (const Edge & edge : edges)
    {
      if (!m_Complex.Star(edge.a).empty() && !m_Complex.Star(edge.b).empty() && CollapseShortEdge(edge.a, edge.b))
      {
        ++count;
      }
    }
  }
  return count;
}

/** The way that leaves the better cells first. */
bool
MeshRepair::CollapseShortEdge(IdType v, IdType w)
{
  constexpr double    AnyPositive = 2.0;
  std::vector<IdType> changed;
  if (WorstAfterCollapse(w, v) < WorstAfterCollapse(v, w))
  {
    std::swap(v, w);
  }
  for (int way = 0; way < 2; ++way)
  {
    const bool allowed =
      m_Complex.Dimension(v) > 0 && (m_Complex.Dimension(v) == 3 || m_Complex.Dimension(w) <= m_Complex.Dimension(v));
    if (allowed && TryCollapse(v, w, AnyPositive, changed))
    {
      return true;
    }
    std::swap(v, w);
  }
  return false;
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
        const double worst = WorstAfterCollapse(v, w, limit);
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
