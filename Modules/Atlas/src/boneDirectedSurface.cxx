/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDirectedSurface.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
const double LeastCosine = std::cos(75.0 * EIGEN_PI / 180.0);

std::vector<Vector3>
CubeDirections()
{
  std::vector<Vector3> directions;
  for (int x = -1; x <= 1; ++x)
  {
    for (int y = -1; y <= 1; ++y)
    {
      for (int z = -1; z <= 1; ++z)
      {
        const int length = std::abs(x) + std::abs(y) + std::abs(z);
        if (length == 1 || length == 3)
        {
          directions.push_back(Vector3(x, y, z).normalized());
        }
      }
    }
  }
  return directions;
}
} // namespace

DirectedSurface::DirectedSurface(const TriangleSurface & surface)
  : m_Surface(surface)
  , m_PointNormals(PointNormals(surface))
{
  for (const Vector3 & direction : CubeDirections())
  {
    m_Buckets.push_back({ direction, TriangleTree(), {} });
  }
  std::vector<std::vector<TriangleTree::Triangle>> lists(m_Buckets.size());
  std::vector<TriangleTree::Triangle>              all;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
  {
    const auto &                 ids = surface.triangles[t];
    const TriangleTree::Triangle triangle = { surface.points[ids[0]], surface.points[ids[1]], surface.points[ids[2]] };
    const Vector3                normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    all.push_back(triangle);
    for (std::size_t b = 0; b < m_Buckets.size(); ++b)
    {
      if (normal.dot(m_Buckets[b].direction) >= LeastCosine * normal.norm())
      {
        lists[b].push_back(triangle);
        m_Buckets[b].triangle.push_back(static_cast<int>(t));
      }
    }
  }
  m_All = TriangleTree(std::move(all));
  for (std::size_t b = 0; b < m_Buckets.size(); ++b)
  {
    m_Buckets[b].tree = TriangleTree(std::move(lists[b]));
  }
}

DirectedSurface::Match
DirectedSurface::Find(const Vector3 & x, const Vector3 & normal) const
{
  const auto bucket =
    std::max_element(m_Buckets.begin(), m_Buckets.end(), [&normal](const Bucket & a, const Bucket & b) {
      return a.direction.dot(normal) < b.direction.dot(normal);
    });
  const auto nearest = bucket->tree.FindNearest(x);
  if (nearest.triangle < 0)
  {
    return {};
  }
  return { nearest.point, nearest.squaredDistance, bucket->triangle[static_cast<std::size_t>(nearest.triangle)] };
}

DirectedSurface::Match
DirectedSurface::FindAny(const Vector3 & x) const
{
  const auto nearest = m_All.FindNearest(x);
  return { nearest.point, nearest.squaredDistance, nearest.triangle };
}

Vector3
DirectedSurface::Weights(int triangle, const Vector3 & x) const
{
  const auto &  ids = m_Surface.triangles[static_cast<std::size_t>(triangle)];
  const Vector3 a = m_Surface.points[ids[0]], ab = m_Surface.points[ids[1]] - a, ac = m_Surface.points[ids[2]] - a;
  const Vector3 normal = ab.cross(ac);
  const double  square = normal.squaredNorm();
  if (!(square > 0))
  {
    return Vector3::Constant(1.0 / 3.0);
  }
  const double v = (x - a).cross(ac).dot(normal) / square, w = ab.cross(x - a).dot(normal) / square;
  return Vector3(1 - v - w, v, w);
}

Vector3
DirectedSurface::NormalAt(int triangle, const Vector3 & x) const
{
  const auto &  ids = m_Surface.triangles[static_cast<std::size_t>(triangle)];
  const Vector3 weights = this->Weights(triangle, x);
  return (weights[0] * m_PointNormals[ids[0]] + weights[1] * m_PointNormals[ids[1]] +
          weights[2] * m_PointNormals[ids[2]])
    .normalized();
}
} // namespace bone
