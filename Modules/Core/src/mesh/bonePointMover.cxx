/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePointMover.h"

#include "bonePredicates.h"
#include "boneTetraFlips.h"

#include <algorithm>

namespace bone
{
namespace
{
/** Boundary triangles are tested against each other but for those of flat cuts: their plane has all others on one side,
 * and within it they cannot overlap while cells are positive and the rim does not cross itself. */
bool
IsTested(const TetraComplex & complex, int surface)
{
  return surface >= 0 && complex.Surfaces().surfaces[surface].IsBoundary() &&
         complex.Surfaces().surfaces[surface].flat < 0;
}

/** Calls visit(triangle) for every boundary triangle that is tested. */
template <typename TVisit>
void
ForEachBoundaryTriangle(const TetraComplex & complex, TVisit visit)
{
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      if (IsTested(complex, complex.FaceSurfaces(t)[i]))
      {
        const Id4 & c = complex.Cell(t);
        visit(TriangleIds{ c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] });
      }
    }
  }
}
} // namespace

PointMover::PointMover(TetraComplex & complex, SurfaceBound * bound, const Execution & execution)
  : m_Complex(complex)
  , m_Bound(bound)
  , m_Execution(execution)
  , m_Grid(MeanBoundaryEdge(complex))
{
  ForEachBoundaryTriangle(complex, [&](const TriangleIds & t) { m_Grid.Insert(t, complex.Points()); });
}

double
PointMover::WorstCosine(IdType p) const
{
  double worst = -1.0;
  for (IdType t : m_Complex.Star(p))
  {
    worst = std::max(worst, CellCosine(m_Complex, t));
  }
  return worst;
}

bool
PointMover::StarIsPositive(IdType p) const
{
  const auto & x = m_Complex.Points();
  const auto & star = m_Complex.Star(p);
  return std::all_of(star.begin(), star.end(), [&](IdType t) {
    const Id4 & c = m_Complex.Cell(t);
    return Orient3D(x[c[0]], x[c[1]], x[c[2]], x[c[3]]) > 0;
  });
}

bool
PointMover::ReplaceSurface(const std::vector<SurfaceTriangle> & removed, const std::vector<SurfaceTriangle> & added)
{
  m_Execution.ThrowIfAborted();
  const auto &             points = m_Complex.Points();
  std::vector<TriangleIds> goes, comes;
  for (const auto & [from, to] : { std::make_pair(&removed, &goes), std::make_pair(&added, &comes) })
  {
    for (const SurfaceTriangle & triangle : *from)
    {
      if (IsTested(m_Complex, triangle.surface))
      {
        to->push_back(triangle.ids);
      }
    }
  }
  for (const TriangleIds & t : goes)
  {
    m_Grid.Erase(t, points);
  }
  bool crosses = false;
  for (std::size_t i = 0; i < comes.size() && !crosses; ++i)
  {
    for (std::size_t j = 0; j < i && !crosses; ++j)
    {
      crosses = TrianglesCross(comes[i], comes[j], points);
    }
    crosses = crosses || m_Grid.Crosses(comes[i], -1, points);
  }
  const bool refused = crosses || (m_Bound && !m_Bound->Replace(removed, added, points));
  for (const TriangleIds & t : refused ? goes : comes)
  {
    m_Grid.Insert(t, points);
  }
  return !refused;
}

void
PointMover::CollectSurface(IdType p)
{
  m_Boundary.clear();
  m_Triangles.clear();
  m_Complex.SurfaceStar(p, m_Faces);
  for (const auto & face : m_Faces)
  {
    m_Triangles.push_back({ { p, face.a, face.b }, face.surface });
    if (IsTested(m_Complex, face.surface))
    {
      m_Boundary.push_back({ p, face.a, face.b });
    }
  }
}

bool
PointMover::BoundaryCrosses(IdType p) const
{
  const auto & points = m_Complex.Points();
  for (std::size_t i = 0; i < m_Boundary.size(); ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      if (TrianglesCross(m_Boundary[i], m_Boundary[j], points))
      {
        return true;
      }
    }
    if (m_Grid.Crosses(m_Boundary[i], p, points))
    {
      return true;
    }
  }
  return false;
}

bool
PointMover::FallsBelow(IdType p, const Vector3 & before, double cosineFloor)
{
  const double worst = this->WorstCosine(p);
  if (worst <= cosineFloor)
  {
    return false;
  }
  const Vector3 x = m_Complex.Points()[p];
  m_Complex.TryPoint(p, before);
  const double former = this->WorstCosine(p);
  m_Complex.TryPoint(p, x);
  return worst > former;
}

MeshOperation
PointMover::TryMove(IdType p, const Vector3 & x, double cosineFloor)
{
  m_Execution.ThrowIfAborted();
  const auto &  points = m_Complex.Points();
  const Vector3 before = points[p];
  m_Complex.TryPoint(p, x);
  MeshOperation outcome = MeshOperation::Done;
  if (!StarIsPositive(p))
  {
    outcome = MeshOperation::Orientation;
  }
  else if (cosineFloor < 1.0 && this->FallsBelow(p, before, cosineFloor))
  {
    outcome = MeshOperation::Quality;
  }
  else if (m_Complex.Dimension(p) < 3)
  {
    CollectSurface(p);
    if (BoundaryCrosses(p))
    {
      outcome = MeshOperation::Overlap;
    }
    else if (m_Bound && !m_Bound->Replace({}, m_Triangles, points))
    {
      outcome = MeshOperation::Distance;
    }
    else
    {
      for (const TriangleIds & t : m_Boundary)
      {
        m_Grid.Move(t, p, before, points);
      }
    }
  }
  if (outcome == MeshOperation::Done)
  {
    m_Complex.MovePoint(p, x);
  }
  else
  {
    m_Complex.TryPoint(p, before);
  }
  return outcome;
}
} // namespace bone
