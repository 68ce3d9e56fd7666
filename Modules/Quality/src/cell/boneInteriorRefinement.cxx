/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneInteriorRefinement.h"

#include "bonePredicates.h"

#include <algorithm>
#include <limits>

namespace bone
{
InteriorRefinement::InteriorRefinement(TetraComplex & complex, MeshRepair & repair, double gradation)
  : m_Complex(complex)
  , m_Repair(repair)
  , m_Gradation(gradation)
{
  FindSizes();
}

void
InteriorRefinement::FindSizes()
{
  const auto & points = m_Complex.Points();
  m_Size.assign(points.size(), std::numeric_limits<double>::max());
  std::vector<TetraComplex::SurfaceFace> faces;
  for (IdType p = 0; p < static_cast<IdType>(points.size()); ++p)
  {
    if (m_Complex.Dimension(p) < 3 && !m_Complex.Star(p).empty())
    {
      double sum = 0.0;
      m_Complex.SurfaceStar(p, faces);
      for (const auto & face : faces)
      {
        sum += (points[face.a] - points[p]).norm() + (points[face.b] - points[p]).norm();
      }
      m_Size[p] = sum / (2.0 * static_cast<double>(faces.size()));
    }
  }
  // The least fixed point of size(q) <= size(p) + gradation |pq| does not depend on the order of the sweeps.
  for (bool changed = true; changed;)
  {
    changed = false;
    for (IdType t = 0; t < m_Complex.Size(); ++t)
    {
      for (int e = 0; m_Complex.IsAlive(t) && e < 6; ++e)
      {
        const IdType a = m_Complex.Cell(t)[TetraEdges[e][0]], b = m_Complex.Cell(t)[TetraEdges[e][1]];
        const double rise = m_Gradation * (points[a] - points[b]).norm();
        for (const auto & [p, q] : { std::make_pair(a, b), std::make_pair(b, a) })
        {
          if (m_Size[p] + rise < m_Size[q] * (1.0 - 1e-9))
          {
            m_Size[q] = m_Size[p] + rise;
            changed = true;
          }
        }
      }
    }
  }
}

double
InteriorRefinement::SizeBetween(IdType a, IdType b) const
{
  const double rise = 0.5 * m_Gradation * (m_Complex.Points()[a] - m_Complex.Points()[b]).norm();
  return std::min(m_Size[a], m_Size[b]) + rise;
}

std::size_t
InteriorRefinement::Split(double factor)
{
  struct Edge
  {
    double excess;
    IdType a;
    IdType b;
  };
  const auto &      points = m_Complex.Points();
  std::vector<Edge> edges;
  for (IdType a = 0; a < static_cast<IdType>(points.size()); ++a)
  {
    for (IdType b : m_Complex.PointNeighbors(a))
    {
      const double excess = a < b ? (points[a] - points[b]).norm() / SizeBetween(a, b) : 0.0;
      if (excess > factor)
      {
        edges.push_back({ excess, a, b });
      }
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge & x, const Edge & y) {
    return x.excess != y.excess ? x.excess > y.excess : x.a != y.a ? x.a < y.a : x.b < y.b;
  });
  std::size_t count = 0;
  for (const Edge & edge : edges)
  {
    const auto    star = m_Complex.EdgeStar(edge.a, edge.b);
    const bool    onSurface = std::any_of(star.begin(), star.end(), [&](IdType t) {
      for (int i = 0; i < 4; ++i)
      {
        const IdType p = m_Complex.Cell(t)[i];
        if (p != edge.a && p != edge.b && m_Complex.FaceSurfaces(t)[i] >= 0)
        {
          return true;
        }
      }
      return false;
    });
    const Vector3 middle = 0.5 * (points[edge.a] + points[edge.b]);
    const bool    positive = std::all_of(star.begin(), star.end(), [&](IdType t) {
      Vector3 x[4];
      for (IdType end : { edge.a, edge.b })
      {
        for (int i = 0; i < 4; ++i)
        {
          const IdType p = m_Complex.Cell(t)[i];
          x[i] = p == end ? middle : points[p];
        }
        if (Orient3D(x[0], x[1], x[2], x[3]) <= 0)
        {
          return false;
        }
      }
      return true;
    });
    if (!star.empty() && !onSurface && positive)
    {
      m_Size.push_back(SizeBetween(edge.a, edge.b));
      m_Complex.SplitEdge(edge.a, edge.b, middle);
      ++count;
    }
  }
  return count;
}

std::size_t
InteriorRefinement::Collapse(double factor, double longest, double cosine)
{
  const auto &                           points = m_Complex.Points();
  std::size_t                            count = 0;
  std::vector<IdType>                    changed;
  std::vector<std::pair<double, IdType>> around;
  for (IdType v = 0; v < static_cast<IdType>(points.size()); ++v)
  {
    if (m_Complex.Dimension(v) < 3 || m_Complex.Star(v).empty())
    {
      continue;
    }
    around.clear();
    const auto neighbors = m_Complex.PointNeighbors(v);
    double     worst = -1.0;
    for (IdType w : neighbors)
    {
      const double length = (points[v] - points[w]).norm() / SizeBetween(v, w);
      if (length < factor)
      {
        around.emplace_back(length, w);
      }
    }
    if (around.empty())
    {
      continue;
    }
    for (IdType t : m_Complex.Star(v))
    {
      worst = std::max(worst, CellCosine(m_Complex, t));
    }
    std::sort(around.begin(), around.end());
    for (const auto & candidate : around)
    {
      const IdType w = candidate.second;
      const bool   fits = std::all_of(neighbors.begin(), neighbors.end(), [&](IdType q) {
        return q == w || (points[q] - points[w]).norm() < longest * SizeBetween(q, w);
      });
      if (fits && m_Repair.TryCollapse(v, w, std::max(worst, cosine), changed))
      {
        ++count;
        break;
      }
    }
  }
  return count;
}
} // namespace bone
