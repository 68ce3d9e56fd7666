/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceTarget.h"

#include <algorithm>
#include <map>

namespace bone
{
namespace
{
/** Share of the Laplacian's Laplacian taken off in a step; stable below 1/2. */
constexpr double FairingStep = 0.4;
/** Area of the faces at a point seen along their mean normal, as a share of their area: below this it is on a ridge. */
constexpr double RidgeShare = 0.9;
constexpr int    NoSurface = -1;
} // namespace

SurfaceTarget::SurfaceTarget(const TetraComplex & complex, double distanceBound, int fairingIterations)
  : m_Faired(Fair(complex, distanceBound, fairingIterations))
  , m_IsRidge(complex.Points().size(), 0)
  , m_Stratum(complex.Points().size(), -1)
{
  FindRidges(complex);
  BuildTrees(complex);
}

void
SurfaceTarget::FindRidges(const TetraComplex & complex)
{
  std::vector<TetraComplex::SurfaceFace> faces;
  for (IdType p = 0; p < static_cast<IdType>(m_Faired.size()); ++p)
  {
    if (complex.Dimension(p) != 2)
    {
      continue;
    }
    complex.SurfaceStar(p, faces);
    Vector3 sum = Vector3::Zero();
    double  area = 0.0;
    for (const auto & face : faces)
    {
      const Vector3 normal = (m_Faired[face.a] - m_Faired[p]).cross(m_Faired[face.b] - m_Faired[p]);
      sum += normal;
      area += normal.norm();
    }
    m_IsRidge[p] = sum.norm() < RidgeShare * area;
  }
}

std::vector<Vector3>
SurfaceTarget::Fair(const TetraComplex & complex, double distanceBound, int iterations) const
{
  const std::vector<Vector3> & original = complex.Points();
  const SurfaceComplex &       surfaces = complex.Surfaces();
  std::vector<Vector3>         points = original;
  if (!(distanceBound > 0))
  {
    return points;
  }
  std::vector<IdType>                    moving;
  std::vector<std::vector<IdType>>       around;
  std::vector<TetraComplex::SurfaceFace> faces;
  for (IdType p = 0; p < static_cast<IdType>(points.size()); ++p)
  {
    const int dimension = surfaces.dimension[p];
    if (dimension != 1 && dimension != 2)
    {
      continue;
    }
    std::vector<IdType> neighbors = surfaces.curve[p];
    if (dimension == 2)
    {
      complex.SurfaceStar(p, faces);
      if (surfaces.surfaces[faces.front().surface].flat >= 0)
      {
        continue;
      }
      for (const auto & face : faces)
      {
        neighbors.push_back(face.a);
      }
    }
    moving.push_back(p);
    around.push_back(std::move(neighbors));
  }
  // Steps down the energy of the Laplacian, which keeps volume to second order where a plain Laplacian shrinks.
  std::vector<Vector3> laplacian(points.size(), Vector3::Zero()), next(moving.size());
  const auto           umbrella = [&around](const std::vector<Vector3> & values, std::size_t i, IdType p) {
    Vector3 mean = Vector3::Zero();
    for (IdType q : around[i])
    {
      mean += values[q] / static_cast<double>(around[i].size());
    }
    return Vector3(mean - values[p]);
  };
  for (int step = 0; step < iterations; ++step)
  {
    for (std::size_t i = 0; i < moving.size(); ++i)
    {
      laplacian[moving[i]] = umbrella(points, i, moving[i]);
    }
    for (std::size_t i = 0; i < moving.size(); ++i)
    {
      next[i] = points[moving[i]] - FairingStep * umbrella(laplacian, i, moving[i]);
    }
    for (std::size_t i = 0; i < moving.size(); ++i)
    {
      const Vector3 & start = original[moving[i]];
      const Vector3   shift = next[i] - start;
      const double    length = shift.norm();
      points[moving[i]] = length > distanceBound ? Vector3(start + shift * (distanceBound / length)) : next[i];
    }
  }
  return points;
}

void
SurfaceTarget::BuildTrees(const TetraComplex & complex)
{
  const std::vector<Vector3> & points = m_Faired;
  const SurfaceComplex &       surfaces = complex.Surfaces();
  // A stratum is named by the surfaces that meet in it: one for a surface, several for a curve.
  std::map<std::vector<int>, int>                  number;
  std::vector<std::vector<TriangleTree::Triangle>> content;
  const auto                                       stratum = [&](const std::vector<int> & name) {
    const auto found = number.emplace(name, static_cast<int>(content.size()));
    if (found.second)
    {
      content.emplace_back();
    }
    return found.first->second;
  };
  m_TreeOfSurface.assign(surfaces.surfaces.size(), -1);
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    for (int i = 0; i < 4; ++i)
    {
      if (complex.IsAlive(t) && complex.Carries(t, i))
      {
        const Id4 &  c = complex.Cell(t);
        const auto & f = TetraFaces[i];
        const int    surface = complex.FaceSurfaces(t)[i];
        m_TreeOfSurface[surface] = stratum({ surface });
        content[m_TreeOfSurface[surface]].push_back({ points[c[f[0]]], points[c[f[1]]], points[c[f[2]]] });
      }
    }
  }
  std::vector<TetraComplex::SurfaceFace> faces;
  for (IdType p = 0; p < static_cast<IdType>(points.size()); ++p)
  {
    const int dimension = surfaces.dimension[p];
    if (dimension != 1 && dimension != 2)
    {
      continue;
    }
    complex.SurfaceStar(p, faces);
    std::vector<int> name;
    for (const auto & face : faces)
    {
      name.push_back(face.surface);
    }
    std::sort(name.begin(), name.end());
    name.erase(std::unique(name.begin(), name.end()), name.end());
    if (dimension == 1)
    {
      // A curve may bound the same surface from both sides; it is no surface's stratum then either.
      name.push_back(NoSurface);
    }
    m_Stratum[p] = stratum(name);
    if (dimension == 1)
    {
      for (IdType q : surfaces.curve[p])
      {
        if (surfaces.dimension[q] == 0 || p < q)
        {
          content[m_Stratum[p]].push_back({ points[p], points[q], points[q] });
        }
      }
    }
  }
  for (auto & triangles : content)
  {
    m_Trees.emplace_back(std::move(triangles));
  }
}

bool
SurfaceTarget::IsWithin(int surface, const Vector3 & x, double squaredDistance) const
{
  return m_Trees[m_TreeOfSurface[surface]].IsWithin(x, squaredDistance);
}

Vector3
SurfaceTarget::Nearest(int surface, const Vector3 & x) const
{
  return m_Trees[m_TreeOfSurface[surface]].FindNearest(x).point;
}

Vector3
SurfaceTarget::Project(const TetraComplex & complex, IdType p, const Vector3 & x) const
{
  const int dimension = complex.Dimension(p);
  if (dimension == 3)
  {
    return x;
  }
  return dimension == 0 ? complex.Points()[p] : m_Trees[m_Stratum[p]].FindNearest(x).point;
}
} // namespace bone
