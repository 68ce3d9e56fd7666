/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshCollapser.h"

#include "bonePredicates.h"
#include "boneQualityMeasures.h"

#include <algorithm>
#include <cmath>

// What a collapse costs, and whether it may be made.
namespace bone
{
namespace
{
constexpr double GoodAngle = 25.0 / 57.29577951308232;
constexpr double ShapeWeight = 0.01;
constexpr double LengthWeight = 1e-3;
constexpr double DeficitWeight = 0.3;
constexpr double SlendernessWeight = 1.0;
constexpr double GoodLength = 4.0; // of a cell's longest edge, in edges of an equilateral tetrahedron

double
LongestEdge(const std::vector<Vector3> & points, const Id4 & cell)
{
  double squared = 0.0;
  for (const auto & edge : TetraEdges)
  {
    squared = std::max(squared, (points[cell[edge[0]]] - points[cell[edge[1]]]).squaredNorm());
  }
  return std::sqrt(squared);
}

bool
IsTested(const TetraComplex & complex, int surface)
{
  // Flat cuts have the whole body on one side of their plane, and cannot overlap in it while cells are positive.
  return surface >= 0 && complex.Surfaces().surfaces[surface].IsBoundary() &&
         complex.Surfaces().surfaces[surface].flat < 0;
}
} // namespace

void
MeshCollapser::FillGrid()
{
  m_Grid = SurfaceGrid(2.0 * m_FirstEdge);
  for (IdType t = 0; t < m_Complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && m_Complex.IsAlive(t); ++i)
    {
      if (IsTested(m_Complex, m_Complex.FaceSurfaces(t)[i]))
      {
        const Id4 & c = m_Complex.Cell(t);
        m_Grid.Insert({ c[TetraFaces[i][0]], c[TetraFaces[i][1]], c[TetraFaces[i][2]] }, m_Complex.Points());
      }
    }
  }
}

void
MeshCollapser::UpdateGrid(IdType v, bool insert)
{
  std::vector<TetraComplex::SurfaceFace> faces;
  m_Complex.SurfaceStar(v, faces);
  for (const auto & face : faces)
  {
    if (IsTested(m_Complex, face.surface))
    {
      const TriangleIds triangle = { v, face.a, face.b };
      insert ? m_Grid.Insert(triangle, m_Complex.Points()) : m_Grid.Erase(triangle, m_Complex.Points());
    }
  }
}

double
MeshCollapser::EquilateralEdge() const
{
  double volume = 0.0;
  for (std::size_t r = 0; r < m_Volumes.Size(); ++r)
  {
    volume += m_Volumes[r];
  }
  return std::cbrt(6.0 * std::sqrt(2.0) * volume / m_Complex.AliveCells());
}

MeshOperation
MeshCollapser::CheckVolume(IdType v, const std::vector<double> & volumes, double & cost) const
{
  if (m_Complex.Dimension(v) == 3)
  {
    return MeshOperation::Done;
  }
  for (std::size_t r = 0; r < volumes.size(); ++r)
  {
    const double before = m_VolumeErrors[r], after = before + volumes[r];
    // A change that brings a region back is always allowed.
    if (std::abs(after) > m_Parameters.maximumVolumeChange * m_Volumes[r] && std::abs(after) > std::abs(before))
    {
      return MeshOperation::Volume;
    }
    cost += m_Parameters.volumeWeight * (after * after - before * before) / m_Volumes[r];
  }
  return MeshOperation::Done;
}

MeshOperation
MeshCollapser::Rate(IdType                v,
                    IdType                w,
                    double                densityCost,
                    const Limits &        limits,
                    std::vector<double> & volumes,
                    double &              cost) const
{
  const auto & p = m_Complex.Points();
  double       worst = -1.0, volume = 0.0, deficit = 0.0, longest = 0.0;
  volumes.assign(m_Volumes.Size(), 0.0);
  for (IdType t : m_Complex.Star(v))
  {
    Id4          c = m_Complex.Cell(t);
    const double before = SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
    double &     change = volumes[m_Volumes.NumberOf(m_Complex.Region(t))];
    change -= before;
    if (m_Complex.Has(t, w))
    {
      continue;
    }
    c[m_Complex.LocalIndex(t, v)] = w;
    const double after = SignedVolume(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
    if (!(after > 0))
    {
      return MeshOperation::Orientation;
    }
    const double cosine = LargestDihedralCosine(p[c[0]], p[c[1]], p[c[2]], p[c[3]]);
    worst = std::max(worst, cosine);
    if (m_Improvement)
    {
      deficit = std::max(deficit, 1.0 - std::acos(cosine) / WantedAngles().Of(m_Complex.Region(t)));
      longest = std::max(longest, LongestEdge(p, c));
    }
    if (cosine > (m_Complex.Region(t) == Cortical ? limits.cortical : limits.other))
    {
      return MeshOperation::Quality;
    }
    change += after;
    volume += after;
  }
  if (!(volume > 0))
  {
    return MeshOperation::Topology; // nothing would be left of the star
  }
  const auto surface = m_SurfaceSamples.CollapseCost(m_Complex, v, w);
  if (surface.largestDistance > m_MaximumDistance)
  {
    return MeshOperation::Distance;
  }
  const double shape = std::max(0.0, 1.0 - std::acos(worst) / GoodAngle);
  const double length = (p[v] - p[w]).norm();
  cost = densityCost + m_Parameters.surfaceWeight * surface.integral + ShapeWeight * volume * shape * shape +
         LengthWeight * length * length * length + DeficitWeight * volume * deficit * deficit;
  if (m_Improvement)
  {
    const double slenderness = std::max(0.0, longest / (GoodLength * EquilateralEdge()) - 1.0);
    cost += SlendernessWeight * volume * slenderness * slenderness;
  }
  return CheckVolume(v, volumes, cost);
}

MeshCollapser::Limits
MeshCollapser::LimitsAround(IdType v) const
{
  Limits limits{ std::cos(m_Floors.cortical), std::cos(m_Floors.other) };
  for (IdType t : m_Complex.Star(v))
  {
    double & limit = m_Complex.Region(t) == Cortical ? limits.cortical : limits.other;
    limit = std::max(limit, CellCosine(m_Complex, t));
  }
  return limits;
}

bool
MeshCollapser::BoundaryCrosses(IdType v, IdType w) const
{
  std::vector<TetraComplex::SurfaceFace> faces;
  std::vector<TriangleIds>               changed;
  m_Complex.SurfaceStar(v, faces);
  for (const auto & face : faces)
  {
    if (IsTested(m_Complex, face.surface) && face.a != w && face.b != w)
    {
      changed.push_back({ w, face.a, face.b });
    }
  }
  const auto & points = m_Complex.Points();
  return std::any_of(
    changed.begin(), changed.end(), [&](const TriangleIds & t) { return m_Grid.Crosses(t, v, points); });
}

MeshOperation
MeshCollapser::CheckExactly(IdType v, IdType w) const
{
  const MeshOperation topology = m_Complex.CanCollapse(v, w);
  if (topology != MeshOperation::Done)
  {
    return topology;
  }
  const auto & p = m_Complex.Points();
  for (IdType t : m_Complex.Star(v))
  {
    Id4 c = m_Complex.Cell(t);
    if (!m_Complex.Has(t, w))
    {
      c[m_Complex.LocalIndex(t, v)] = w;
      if (Orient3D(p[c[0]], p[c[1]], p[c[2]], p[c[3]]) <= 0)
      {
        return MeshOperation::Orientation;
      }
    }
  }
  if (m_Complex.Dimension(v) == 3)
  {
    return MeshOperation::Done;
  }
  if (m_Envelope && !m_Envelope->Allows(m_Complex, v, w, m_MaximumDistance))
  {
    return MeshOperation::Distance;
  }
  return BoundaryCrosses(v, w) ? MeshOperation::Overlap : MeshOperation::Done;
}

MeshCollapser::Candidate
MeshCollapser::FindBest(IdType v) const
{
  std::vector<IdType>                    targets;
  std::vector<TetraComplex::SurfaceFace> faces;
  switch (m_Complex.Dimension(v))
  {
    case 1:
      targets = m_Complex.Surfaces().curve[v];
      break;
    case 2:
      m_Complex.SurfaceStar(v, faces);
      for (const auto & face : faces)
      {
        targets.push_back(face.a);
      }
      break;
    default:
      targets = m_Complex.PointNeighbors(v);
  }
  const Limits limits = LimitsAround(v);
  const double densityCost =
    m_Parameters.densityWeight > 0 && !m_Densities.IsEmpty()
      ? m_Parameters.densityWeight * m_Densities.RemovalCost(m_Complex, v) / (m_Densities.Range() * m_Densities.Range())
      : 0.0;
  Candidate                              best;
  std::vector<double>                    volumes;
  std::vector<std::pair<double, IdType>> rated;
  for (IdType w : targets)
  {
    double              cost = 0.0;
    const MeshOperation outcome = Rate(v, w, densityCost, limits, volumes, cost);
    if (outcome == MeshOperation::Done)
    {
      rated.emplace_back(cost, w);
    }
    else
    {
      ++best.refused[static_cast<int>(outcome)];
    }
  }
  std::sort(rated.begin(), rated.end());
  for (const auto & candidate : rated)
  {
    const MeshOperation outcome = CheckExactly(v, candidate.second);
    if (outcome == MeshOperation::Done)
    {
      best.cost = candidate.first;
      best.w = candidate.second;
      break;
    }
    ++best.refused[static_cast<int>(outcome)];
  }
  return best;
}
} // namespace bone
