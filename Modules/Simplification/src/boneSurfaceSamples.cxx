/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceSamples.h"

#include "boneTriangleTree.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
struct Target
{
  int     surface;
  Vector3 a;
  Vector3 b;
  Vector3 c;
};

double
SquaredDistance(const Vector3 & x, int surface, const std::vector<Target> & targets)
{
  double best = std::numeric_limits<double>::max();
  for (const Target & t : targets)
  {
    if (t.surface == surface)
    {
      best = std::min(best, (ClosestPointOnTriangle(x, t.a, t.b, t.c) - x).squaredNorm());
    }
  }
  return best;
}
} // namespace

SurfaceSamples::SurfaceSamples(const TetraComplex & complex)
  : m_InCell(complex.Size())
  , m_Shares(complex.Points().size())
{
  const auto &                           points = complex.Points();
  std::vector<TetraComplex::SurfaceFace> faces;
  for (IdType p = 0; p < static_cast<IdType>(points.size()); ++p)
  {
    complex.SurfaceStar(p, faces);
    for (const auto & face : faces)
    {
      const double area = (points[face.a] - points[p]).cross(points[face.b] - points[p]).norm() / 6.0;
      auto &       shares = m_Shares[p];
      auto         at =
        std::find_if(shares.begin(), shares.end(), [&face](const Share & s) { return s.surface == face.surface; });
      if (at == shares.end())
      {
        shares.push_back({ face.surface, area });
      }
      else
      {
        at->area += area;
      }
    }
  }
}

SurfaceSamples::Cost
SurfaceSamples::CollapseCost(const TetraComplex & complex, IdType v, IdType w) const
{
  Cost cost;
  if (complex.Dimension(v) == 3)
  {
    return cost;
  }
  std::vector<TetraComplex::SurfaceFace> faces;
  complex.SurfaceStar(v, faces);
  const auto &        points = complex.Points();
  std::vector<Target> targets;
  std::vector<IdType> cells;
  for (const auto & face : faces)
  {
    if (face.a != w && face.b != w)
    {
      targets.push_back({ face.surface, points[w], points[face.a], points[face.b] });
    }
    if (std::find(cells.begin(), cells.end(), face.cell) == cells.end())
    {
      cells.push_back(face.cell);
      // A face beside v that the same cell carries stays; its points are in the same list.
      const int i = complex.LocalIndex(face.cell, v);
      if (complex.Carries(face.cell, i))
      {
        const Id4 &  c = complex.Cell(face.cell);
        const auto & f = TetraFaces[i];
        targets.push_back({ complex.FaceSurfaces(face.cell)[i], points[c[f[0]]], points[c[f[1]]], points[c[f[2]]] });
      }
    }
  }
  double     largest = 0.0;
  const auto add = [&](const Vector3 & x, int surface, double area, double before) {
    const double squared = SquaredDistance(x, surface, targets);
    cost.integral += area * (squared - before);
    largest = std::max(largest, squared);
  };
  for (const Share & share : m_Shares[v])
  {
    add(points[v], share.surface, share.area, 0.0);
  }
  for (IdType t : cells)
  {
    for (int s : m_InCell[t])
    {
      add(m_Samples[s].x, m_Samples[s].surface, m_Samples[s].area, m_Samples[s].squaredDistance);
    }
  }
  cost.largestDistance = std::sqrt(largest);
  return cost;
}

std::vector<int>
SurfaceSamples::TakeFrom(const TetraComplex & complex, const std::vector<IdType> & cells, IdType v)
{
  std::vector<int> taken;
  for (IdType t : cells)
  {
    taken.insert(taken.end(), m_InCell[t].begin(), m_InCell[t].end());
    m_InCell[t].clear();
  }
  if (v >= 0)
  {
    for (const Share & share : m_Shares[v])
    {
      taken.push_back(static_cast<int>(m_Samples.size()));
      m_Samples.push_back({ complex.Points()[v], share.surface, share.area, 0.0 });
    }
  }
  return taken;
}

void
SurfaceSamples::GiveTo(const TetraComplex &        complex,
                       const std::vector<int> &    samples,
                       const std::vector<IdType> & cells)
{
  m_InCell.resize(complex.Size());
  if (samples.empty())
  {
    return;
  }
  const auto &        points = complex.Points();
  std::vector<Target> targets;
  std::vector<IdType> owner;
  for (IdType t : cells)
  {
    for (int i = 0; i < 4; ++i)
    {
      if (complex.Carries(t, i))
      {
        const Id4 &  c = complex.Cell(t);
        const auto & f = TetraFaces[i];
        targets.push_back({ complex.FaceSurfaces(t)[i], points[c[f[0]]], points[c[f[1]]], points[c[f[2]]] });
        owner.push_back(t);
      }
    }
  }
  for (int s : samples)
  {
    Sample & sample = m_Samples[s];
    double   best = std::numeric_limits<double>::max();
    IdType   at = -1;
    for (std::size_t i = 0; i < targets.size(); ++i)
    {
      if (targets[i].surface == sample.surface)
      {
        const Target & t = targets[i];
        const double   squared = (ClosestPointOnTriangle(sample.x, t.a, t.b, t.c) - sample.x).squaredNorm();
        if (squared < best)
        {
          best = squared;
          at = owner[i];
        }
      }
    }
    if (at >= 0)
    {
      sample.squaredDistance = best;
      m_InCell[at].push_back(s);
    }
  }
}

void
SurfaceSamples::Distribute(const TetraComplex & complex)
{
  const std::size_t                                surfaces = complex.Surfaces().surfaces.size();
  std::vector<std::vector<TriangleTree::Triangle>> triangles(surfaces);
  std::vector<std::vector<IdType>>                 owners(surfaces);
  const auto &                                     points = complex.Points();
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4 && complex.IsAlive(t); ++i)
    {
      if (complex.Carries(t, i))
      {
        const Id4 &  c = complex.Cell(t);
        const auto & f = TetraFaces[i];
        const auto   surface = static_cast<std::size_t>(complex.FaceSurfaces(t)[i]);
        triangles[surface].push_back({ points[c[f[0]]], points[c[f[1]]], points[c[f[2]]] });
        owners[surface].push_back(t);
      }
    }
  }
  const std::vector<TriangleTree> trees(triangles.begin(), triangles.end());
  m_InCell.assign(complex.Size(), {});
  for (std::size_t s = 0; s < m_Samples.size(); ++s)
  {
    Sample &   sample = m_Samples[s];
    const auto nearest = trees[sample.surface].FindNearest(sample.x);
    sample.squaredDistance = nearest.squaredDistance;
    m_InCell[owners[sample.surface][nearest.triangle]].push_back(static_cast<int>(s));
  }
}
} // namespace bone
