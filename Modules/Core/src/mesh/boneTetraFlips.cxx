/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTetraFlips.h"

#include "bonePredicates.h"
#include "boneQualityMeasures.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
/** A flip must gain this much in the cosine, so that rounding cannot make flips go round in circles. */
constexpr double MinimumGain = 1e-6;

double
Cosine(const TetraComplex & complex, const Id4 & c)
{
  const auto & p = complex.Points();
  return LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
}

bool
IsPositive(const TetraComplex & complex, const Id4 & c)
{
  const auto & p = complex.Points();
  return Orient3D(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) > 0;
}

FlipResult
Commit(TetraComplex &           complex,
       std::vector<IdType>      removed,
       const std::vector<Id4> & created,
       double                   before,
       const FlipGuard &        guard)
{
  FlipResult result;
  double     after = -1.0;
  for (const Id4 & c : created)
  {
    after = std::max(after, Cosine(complex, c));
  }
  if (!(after < before - MinimumGain))
  {
    return result;
  }
  for (const Id4 & c : created)
  {
    if (!IsPositive(complex, c))
    {
      result.outcome = MeshOperation::Orientation;
      return result;
    }
  }
  if (guard && !guard(created))
  {
    result.outcome = MeshOperation::Density;
    return result;
  }
  result.created = complex.Replace(removed, created);
  result.removed = std::move(removed);
  result.outcome = MeshOperation::Done;
  return result;
}

/** Cells around edge (a, b) in ring order and the ring's points; cells[k] lies between points k and k + 1. */
struct Ring
{
  std::array<IdType, MaximumEdgeRing> cells;
  std::array<IdType, MaximumEdgeRing> points;
  int                                 cellCount{ 0 };
  int                                 pointCount{ 0 };

  void
  AddCell(IdType t)
  {
    cells[cellCount++] = t;
  }
  void
  AddPoint(IdType p)
  {
    points[pointCount++] = p;
  }
  void
  TurnPoints()
  {
    std::reverse(points.begin(), points.begin() + pointCount);
  }
};

/** Walks around the edge from a cell that has it. Surface where it lies on one, Quality where the ring is too long. */
MeshOperation
FindRing(const TetraComplex & complex, IdType a, IdType b, IdType t, Ring & ring)
{
  int from = -1, to = -1;
  for (int i = 0; i < 4; ++i)
  {
    const IdType p = complex.Cell(t)[i];
    if (p != a && p != b)
    {
      (from < 0 ? from : to) = i;
    }
  }
  do
  {
    if (complex.FaceSurfaces(t)[from] >= 0)
    {
      return MeshOperation::Surface;
    }
    if (ring.cellCount == MaximumEdgeRing)
    {
      return MeshOperation::Quality;
    }
    ring.AddCell(t);
    ring.AddPoint(complex.Cell(t)[from]);
    const IdType pivot = complex.Cell(t)[to];
    // The next cell lies across the face without `from`; there, `pivot` is the point to leave from.
    t = complex.Neighbors(t)[from];
    from = complex.LocalIndex(t, pivot);
    for (to = 0; to == from || complex.Cell(t)[to] == a || complex.Cell(t)[to] == b;)
    {
      ++to;
    }
  } while (t != ring.cells[0]);
  // Ring points must turn positively around a -> b.
  const auto & p = complex.Points();
  if (Orient3D(p[a], p[ring.points[0]], p[ring.points[1]], p[b]) < 0)
  {
    ring.TurnPoints();
  }
  return MeshOperation::Done;
}

/** Best triangulation of a ring's polygon: worst cosine of the two cells on each triangle, minimised. One that is not
 * below `limit` is of no use, and is not looked for. */
class RingTriangulation
{
public:
  RingTriangulation(const TetraComplex & complex, const Ring & ring, IdType a, IdType b, double limit)
    : m_Complex(complex)
    , m_Points(ring.points)
    , m_Count(ring.pointCount)
    , m_A(a)
    , m_B(b)
    , m_Limit(limit)
  {
    for (int width = 2; width < m_Count; ++width)
    {
      for (int i = 0; i + width < m_Count; ++i)
      {
        Solve(i, i + width);
      }
    }
  }

  /** 2 where all are refused. */
  double
  Worst() const
  {
    return m_Cost[0][m_Count - 1];
  }

  std::vector<Id4>
  Cells() const
  {
    std::vector<Id4> cells;
    Collect(0, m_Count - 1, cells);
    return cells;
  }

private:
  std::array<Id4, 2>
  CellsAt(int i, int k, int j) const
  {
    const IdType p = m_Points[i], q = m_Points[k], r = m_Points[j];
    return { Id4{ m_A, p, q, r }, Id4{ m_B, r, q, p } };
  }

  void
  Solve(int i, int j)
  {
    m_Cost[i][j] = 2.0;
    double limit = m_Limit;
    for (int k = i + 1; k < j; ++k)
    {
      double cost = std::max(k > i + 1 ? m_Cost[i][k] : -1.0, j > k + 1 ? m_Cost[k][j] : -1.0);
      for (const Id4 & cell : CellsAt(i, k, j))
      {
        cost = cost < limit ? std::max(cost, CosineIfPositive(cell)) : 2.0;
      }
      if (cost < limit)
      {
        limit = cost;
        m_Cost[i][j] = cost;
        m_Split[i][j] = k;
      }
    }
  }

  double
  CosineIfPositive(const Id4 & cell) const
  {
    const auto & p = m_Complex.Points();
    const bool   positive = SignedVolume(p[cell[0]], p[cell[1]], p[cell[2]], p[cell[3]]) > 0;
    return positive ? Cosine(m_Complex, cell) : 2.0;
  }

  void
  Collect(int i, int j, std::vector<Id4> & cells) const
  {
    if (j < i + 2)
    {
      return;
    }
    const int k = m_Split[i][j];
    for (const Id4 & cell : CellsAt(i, k, j))
    {
      cells.push_back(cell);
    }
    Collect(i, k, cells);
    Collect(k, j, cells);
  }

  const TetraComplex &                        m_Complex;
  const std::array<IdType, MaximumEdgeRing> & m_Points;
  int                                         m_Count;
  IdType                                      m_A;
  IdType                                      m_B;
  double                                      m_Limit;
  double                                      m_Cost[MaximumEdgeRing][MaximumEdgeRing];
  int                                         m_Split[MaximumEdgeRing][MaximumEdgeRing];
};

/** Cells on one side of a surface edge, from its face with `from` to its other face; Surface where the walk meets
 * another surface first, Quality where it is too long. The cells turn around the edge in the order of the points. */
MeshOperation
FindHalfRing(const TetraComplex & complex, IdType a, IdType b, IdType first, int firstFace, Ring & ring)
{
  // `face` is the position of the point opposite the surface face, so the walk leaves through the face opposite `from`.
  IdType     t = first;
  int        next = firstFace;
  const auto other = [&](int not1) {
    int i = 0;
    while (i == not1 || complex.Cell(t)[i] == a || complex.Cell(t)[i] == b)
    {
      ++i;
    }
    return i;
  };
  int from = other(next);
  for (;;)
  {
    ring.AddPoint(complex.Cell(t)[from]);
    ring.AddCell(t);
    if (complex.FaceSurfaces(t)[from] >= 0)
    {
      ring.AddPoint(complex.Cell(t)[next]);
      return MeshOperation::Done;
    }
    if (ring.cellCount == MaximumEdgeRing - 1)
    {
      return MeshOperation::Quality;
    }
    const IdType pivot = complex.Cell(t)[next];
    t = complex.Neighbors(t)[from];
    from = complex.LocalIndex(t, pivot);
    next = other(from);
  }
}

/** Edge removal from a cell that has the edge: stars may be large. `ring` gets the cells that were looked at. */
FlipResult
RemoveEdgeAt(TetraComplex & complex, IdType a, IdType b, IdType cell, Ring & ring, const FlipGuard & guard = {})
{
  FlipResult result;
  result.outcome = FindRing(complex, a, b, cell, ring);
  if (result.outcome != MeshOperation::Done)
  {
    return result;
  }
  double before = -1.0;
  for (int k = 0; k < ring.cellCount; ++k)
  {
    before = std::max(before, CellCosine(complex, ring.cells[k]));
  }
  const RingTriangulation triangulation(complex, ring, a, b, before - MinimumGain);
  if (!(triangulation.Worst() < before - MinimumGain))
  {
    result.outcome = MeshOperation::Quality;
    return result;
  }
  return Commit(
    complex, { ring.cells.begin(), ring.cells.begin() + ring.cellCount }, triangulation.Cells(), before, guard);
}

/** Tries all flips at one cell; the first that is done ends it. */
class CellImprover
{
public:
  CellImprover(TetraComplex &         complex,
               const FlipParameters & parameters,
               FlipMemory &           memory,
               FlipReport &           report,
               const FlipObserver &   observer)
    : m_Complex(complex)
    , m_Parameters(parameters)
    , m_Memory(memory)
    , m_Report(report)
    , m_Observer(observer)
  {}

  bool
  Run(IdType t)
  {
    const Id4  cell = m_Complex.Cell(t);
    const bool all = m_Parameters.cellCount == FlipCellCount::Any;
    for (int e = 0; e < 6; ++e)
    {
      const IdType a = cell[TetraEdges[e][0]], b = cell[TetraEdges[e][1]];
      if (m_Memory.IsEdgeRefused(m_Complex, t, e))
      {
        continue;
      }
      const std::size_t ring = all ? 4 : RingLength(a, b);
      const bool        fewer =
        m_Parameters.cellCount != FlipCellCount::Same && m_Complex.AliveCells() > m_Parameters.minimumCells;
      if (ring > 4 || (ring < 4 && !fewer))
      {
        continue;
      }
      Ring looked;
      if (Note(RemoveEdgeAt(m_Complex, a, b, t, looked, m_Parameters.guard)))
      {
        return true;
      }
      m_Memory.RefuseEdge(m_Complex, t, a, b);
      for (int k = 0; k < looked.cellCount; ++k)
      {
        m_Memory.RefuseEdge(m_Complex, looked.cells[k], a, b);
      }
    }
    for (int i = 0; i < 4 && all; ++i)
    {
      if (!m_Memory.IsFaceRefused(m_Complex, t, i))
      {
        if (Note(RemoveFace(m_Complex, t, i, m_Parameters.guard)))
        {
          return true;
        }
        m_Memory.RefuseFace(m_Complex, t, i);
      }
    }
    m_Memory.RefuseCell(m_Complex, t);
    return false;
  }

private:
  std::size_t
  RingLength(IdType a, IdType b) const
  {
    const auto & star = m_Complex.Star(a);
    return static_cast<std::size_t>(
      std::count_if(star.begin(), star.end(), [&](IdType t) { return m_Complex.Has(t, b); }));
  }

  bool
  Note(const FlipResult & result)
  {
    if (result.outcome != MeshOperation::Done)
    {
      ++m_Report.refused[static_cast<int>(result.outcome)];
      return false;
    }
    ++m_Report.done;
    if (m_Observer)
    {
      m_Observer(result);
    }
    return true;
  }

  TetraComplex &         m_Complex;
  const FlipParameters & m_Parameters;
  FlipMemory &           m_Memory;
  FlipReport &           m_Report;
  const FlipObserver &   m_Observer;
};
} // namespace

double
CellCosine(const TetraComplex & complex, IdType t)
{
  return Cosine(complex, complex.Cell(t));
}

FlipResult
RemoveFace(TetraComplex & complex, IdType t, int i, const FlipGuard & guard)
{
  FlipResult   result;
  const IdType other = complex.Neighbors(t)[i];
  if (other < 0 || complex.FaceSurfaces(t)[i] >= 0)
  {
    result.outcome = MeshOperation::Surface;
    return result;
  }
  const Id4 cell = complex.Cell(t);
  IdType    apex = -1;
  for (int k = 0; k < 4; ++k)
  {
    if (complex.Neighbors(other)[k] == t)
    {
      apex = complex.Cell(other)[k];
    }
  }
  // The face looks outward from t, so the apex beyond lies on its positive side.
  std::vector<Id4> created;
  for (int k = 0; k < 3; ++k)
  {
    created.push_back({ cell[TetraFaces[i][k]], cell[TetraFaces[i][(k + 1) % 3]], apex, cell[i] });
    std::swap(created.back()[0], created.back()[1]);
  }
  return Commit(complex, { t, other }, created, std::max(CellCosine(complex, t), CellCosine(complex, other)), guard);
}

FlipResult
RemoveEdge(TetraComplex & complex, IdType a, IdType b)
{
  const auto & star = complex.Star(a);
  const auto   first = std::find_if(star.begin(), star.end(), [&](IdType t) { return complex.Has(t, b); });
  if (first == star.end())
  {
    FlipResult result;
    result.outcome = MeshOperation::Topology;
    return result;
  }
  Ring ring;
  return RemoveEdgeAt(complex, a, b, *first, ring);
}

SurfaceFlip
PlanSurfaceFlip(const TetraComplex & complex, IdType a, IdType b, double enough)
{
  SurfaceFlip       plan;
  std::vector<Ring> sides;
  double            before = -1.0;
  int               faces = 0;
  plan.edge = { a, b };
  for (IdType t : complex.EdgeStar(a, b))
  {
    before = std::max(before, CellCosine(complex, t));
    for (int i = 0; i < 4; ++i)
    {
      const IdType p = complex.Cell(t)[i];
      const int    surface = complex.FaceSurfaces(t)[i];
      if (p == a || p == b || surface < 0)
      {
        continue;
      }
      ++faces;
      const bool boundary = complex.Neighbors(t)[i] < 0;
      if (plan.surface >= 0 && surface != plan.surface)
      {
        return plan;
      }
      plan.surface = surface;
      // Each side is walked once: from the first of its faces that is met.
      const bool walked = std::any_of(sides.begin(), sides.end(), [t](const Ring & side) {
        return side.cells[0] == t || side.cells[side.cellCount - 1] == t;
      });
      if (!walked)
      {
        sides.emplace_back();
        const MeshOperation found = FindHalfRing(complex, a, b, t, i, sides.back());
        if (found != MeshOperation::Done)
        {
          plan.outcome = found;
          return plan;
        }
      }
      if (static_cast<int>(sides.size()) > (boundary ? 1 : 2))
      {
        return plan;
      }
    }
  }
  if (sides.empty() || faces != 2 * static_cast<int>(sides.size()))
  {
    return plan;
  }
  const IdType c = sides[0].points[0], d = sides[0].points[sides[0].pointCount - 1];
  plan.corners = { c, d };
  bool single = false;
  for (Ring & side : sides)
  {
    if (side.cellCount == 1)
    {
      const IdType t = side.cells[0];
      if (single || complex.FaceSurfaces(t)[complex.LocalIndex(t, a)] >= 0 ||
          complex.FaceSurfaces(t)[complex.LocalIndex(t, b)] >= 0)
      {
        return plan;
      }
      single = true;
    }
  }
  plan.outcome = MeshOperation::Topology;
  for (IdType t : complex.EdgeStar(c, d))
  {
    for (int i = 0; i < 4; ++i)
    {
      const IdType p = complex.Cell(t)[i];
      if (!single || (p != c && p != d && complex.FaceSurfaces(t)[i] >= 0))
      {
        return plan;
      }
    }
  }
  plan.outcome = MeshOperation::Quality;
  const auto & p = complex.Points();
  const double limit = std::max(before - MinimumGain, enough);
  double       after = -1.0;
  for (Ring & side : sides)
  {
    const int region = complex.Region(side.cells[0]);
    plan.removed.insert(plan.removed.end(), side.cells.begin(), side.cells.begin() + side.cellCount);
    if (side.cellCount == 1)
    {
      continue;
    }
    if (Orient3D(p[a], p[side.points[0]], p[side.points[1]], p[b]) < 0)
    {
      side.TurnPoints();
    }
    const RingTriangulation triangulation(complex, side, a, b, limit);
    after = std::max(after, triangulation.Worst());
    if (!(after < limit))
    {
      return plan;
    }
    for (const Id4 & cell : triangulation.Cells())
    {
      plan.created.push_back(cell);
      plan.regions.push_back(region);
    }
  }
  const bool positive = std::all_of(
    plan.created.begin(), plan.created.end(), [&complex](const Id4 & cell) { return IsPositive(complex, cell); });
  plan.outcome = positive ? MeshOperation::Done : MeshOperation::Orientation;
  return plan;
}

int
FlipMemory::EdgeOf(const TetraComplex & complex, IdType t, IdType a, IdType b)
{
  constexpr int edges[4][4] = { { -1, 0, 1, 2 }, { 0, -1, 3, 4 }, { 1, 3, -1, 5 }, { 2, 4, 5, -1 } };
  return edges[complex.LocalIndex(t, a)][complex.LocalIndex(t, b)];
}

void
FlipMemory::Reserve(const TetraComplex & complex)
{
  m_Cells.resize(complex.Size());
}

bool
FlipMemory::IsEdgeRefused(const TetraComplex & complex, IdType t, int edge) const
{
  const std::uint32_t time = m_Cells[t].edges[edge];
  const Id4 &         c = complex.Cell(t);
  return time > 0 &&
         !(complex.HasChanged(c[TetraEdges[edge][0]], time) && complex.HasChanged(c[TetraEdges[edge][1]], time));
}

bool
FlipMemory::IsFaceRefused(const TetraComplex & complex, IdType t, int face) const
{
  const std::uint32_t time = m_Cells[t].faces[face];
  const Id4 &         c = complex.Cell(t);
  const auto &        f = TetraFaces[face];
  return time > 0 &&
         !(complex.HasChanged(c[f[0]], time) && complex.HasChanged(c[f[1]], time) && complex.HasChanged(c[f[2]], time));
}

bool
FlipMemory::IsCellRefused(const TetraComplex & complex, IdType t) const
{
  const std::uint32_t time = m_Cells[t].cell;
  const Id4 &         c = complex.Cell(t);
  return time > 0 &&
         std::none_of(c.begin(), c.end(), [&complex, time](IdType p) { return complex.HasChanged(p, time); });
}

void
FlipMemory::RefuseEdge(const TetraComplex & complex, IdType t, IdType a, IdType b)
{
  m_Cells[t].edges[EdgeOf(complex, t, a, b)] = complex.Clock();
}

void
FlipMemory::RefuseFace(const TetraComplex & complex, IdType t, int face)
{
  m_Cells[t].faces[face] = complex.Clock();
  const IdType other = complex.Neighbors(t)[face];
  for (int k = 0; k < 4 && other >= 0; ++k)
  {
    if (complex.Neighbors(other)[k] == t)
    {
      m_Cells[other].faces[k] = complex.Clock();
    }
  }
}

void
FlipMemory::RefuseCell(const TetraComplex & complex, IdType t)
{
  m_Cells[t].cell = complex.Clock();
}

FlipReport
ImproveByFlips(TetraComplex &         complex,
               const FlipParameters & parameters,
               const FlipObserver &   observer,
               FlipMemory *           memory,
               const Execution &      execution)
{
  FlipReport   report;
  FlipMemory   own;
  FlipMemory & known = memory ? *memory : own;
  CellImprover improver(complex, parameters, known, report, observer);
  const double limit = std::cos(parameters.targetAngle);
  for (int pass = 0; pass < parameters.maximumPasses; ++pass)
  {
    known.Reserve(complex);
    std::vector<std::pair<double, IdType>> worst;
    for (IdType t = 0; t < complex.Size(); ++t)
    {
      const bool   looked = complex.IsAlive(t) && !known.IsCellRefused(complex, t);
      const double cosine = looked ? CellCosine(complex, t) : -1.0;
      if (cosine > limit)
      {
        worst.emplace_back(-cosine, t);
      }
    }
    std::sort(worst.begin(), worst.end());
    const std::size_t before = report.done;
    std::size_t       seen = 0;
    for (const auto & candidate : worst)
    {
      execution.Report((pass + static_cast<double>(++seen) / static_cast<double>(worst.size())) /
                       parameters.maximumPasses);
      if (complex.IsAlive(candidate.second) && CellCosine(complex, candidate.second) > limit)
      {
        known.Reserve(complex);
        improver.Run(candidate.second);
      }
    }
    if (report.done == before)
    {
      break;
    }
  }
  return report;
}
} // namespace bone
