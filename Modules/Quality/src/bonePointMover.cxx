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
      if (bone::IsTested(complex, complex.FaceSurfaces(t)[i]))
      {
        const Id4 & c = complex.Cell(t);
        visit(TriangleIds{ c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] });
      }
    }
  }
}

double
MeanBoundaryEdge(const TetraComplex & complex)
{
  const auto & points = complex.Points();
  double       sum = 0.0;
  std::size_t  count = 0;
  ForEachBoundaryTriangle(complex, [&](const TriangleIds & t) {
    sum += (points[t[0]] - points[t[1]]).norm();
    ++count;
  });
  return sum > 0 ? sum / static_cast<double>(count) : 1.0;
}
} // namespace

PointMover::PointMover(TetraComplex & complex)
  : m_Complex(complex)
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
PointMover::IsTested(int surface) const
{
  return bone::IsTested(m_Complex, surface);
}

bool
PointMover::ReplaceBoundary(const std::vector<TriangleIds> & removed, const std::vector<TriangleIds> & added)
{
  const auto & points = m_Complex.Points();
  for (const TriangleIds & t : removed)
  {
    m_Grid.Erase(t, points);
  }
  bool crosses = false;
  for (std::size_t i = 0; i < added.size() && !crosses; ++i)
  {
    for (std::size_t j = 0; j < i && !crosses; ++j)
    {
      crosses = TrianglesCross(added[i], added[j], points);
    }
    crosses = crosses || m_Grid.Crosses(added[i], -1, points);
  }
  for (const TriangleIds & t : crosses ? removed : added)
  {
    m_Grid.Insert(t, points);
  }
  return !crosses;
}

void
PointMover::CollectBoundary(IdType p)
{
  m_Boundary.clear();
  m_Complex.SurfaceStar(p, m_Faces);
  for (const auto & face : m_Faces)
  {
    if (IsTested(face.surface))
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

MeshOperation
PointMover::TryMove(IdType p, const Vector3 & x, double cosineFloor)
{
  const auto &  points = m_Complex.Points();
  const Vector3 before = points[p];
  const double  worst = cosineFloor < 1.0 ? WorstCosine(p) : 1.0;
  m_Complex.MovePoint(p, x);
  MeshOperation outcome = MeshOperation::Done;
  if (!StarIsPositive(p))
  {
    outcome = MeshOperation::Orientation;
  }
  else if (cosineFloor < 1.0 && WorstCosine(p) > std::max(worst, cosineFloor))
  {
    outcome = MeshOperation::Quality;
  }
  else if (m_Complex.Dimension(p) < 3)
  {
    CollectBoundary(p);
    if (BoundaryCrosses(p))
    {
      outcome = MeshOperation::Overlap;
    }
    else
    {
      for (const TriangleIds & t : m_Boundary)
      {
        m_Complex.MovePoint(p, before);
        m_Grid.Erase(t, points);
        m_Complex.MovePoint(p, x);
        m_Grid.Insert(t, points);
      }
    }
  }
  if (outcome != MeshOperation::Done)
  {
    m_Complex.MovePoint(p, before);
  }
  return outcome;
}
} // namespace bone
