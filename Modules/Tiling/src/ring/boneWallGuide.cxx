/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneWallGuide.h"

#include <cmath>
#include <map>
#include <set>

namespace bone
{
namespace tiling
{
namespace
{
constexpr double DepartureShare = 0.15; // of the slices' distance and the contours' mean step

Vector3
InSlice(const Vector2 & q)
{
  return { q.x(), q.y(), 0.0 };
}
} // namespace

WallGuide::Contour::Contour(const VertexPool & pool, const Walk & walk)
{
  std::set<Edge> walked;
  for (std::size_t i = 0; i < walk.size(); ++i)
  {
    walked.insert({ { walk[i], walk[(i + 1) % walk.size()] } });
  }
  std::vector<Edge>                   edges;
  std::map<int, Vector2>              atVertex;
  std::vector<TriangleTree::Triangle> triangles;
  double                              area = 0.0;
  for (const Edge & edge : walked)
  {
    if (edge[0] == edge[1] || walked.count({ { edge[1], edge[0] } }) > 0)
    {
      continue;
    }
    const Vector2 & p = pool.plane[edge[0]];
    const Vector2 & q = pool.plane[edge[1]];
    const Vector2   normal = Vector2(q.y() - p.y(), p.x() - q.x()).normalized();
    for (int v : edge)
    {
      atVertex.emplace(v, Vector2::Zero()).first->second += normal;
    }
    edges.push_back(edge);
    normals.push_back({ { normal, normal, normal } });
    triangles.push_back({ { InSlice(p), InSlice(q), InSlice(q) } });
    step += (q - p).norm();
    const Vector2 &o = pool.plane[edges[0][0]], u = p - o, w = q - o;
    const double   twice = u.x() * w.y() - u.y() * w.x();
    area += twice;
    centroid += twice / 3.0 * (u + w);
  }
  for (std::size_t i = 0; i < edges.size(); ++i)
  {
    normals[i][1] = atVertex[edges[i][0]];
    normals[i][2] = atVertex[edges[i][1]];
  }
  if (!edges.empty() && area != 0)
  {
    centroid = centroid / area + pool.plane[edges[0][0]];
    step /= static_cast<double>(edges.size());
  }
  segments = TriangleTree(std::move(triangles));
}

double
WallGuide::Contour::SignedDistance(const Vector2 & q) const
{
  const auto    nearest = segments.FindNearest(InSlice(q));
  const auto &  segment = segments.GetTriangle(nearest.triangle);
  const int     end = nearest.point == segment[0] ? 1 : (nearest.point == segment[1] ? 2 : 0);
  const Vector2 way = q - nearest.point.head<2>();
  return std::copysign(std::sqrt(nearest.squaredDistance), way.dot(normals[nearest.triangle][end]));
}

WallGuide::WallGuide(const VertexPool & pool, const Walk & lower, const Walk & upper)
  : m_Pool(pool)
  , m_Lower(pool, lower)
  , m_Upper(pool, upper)
{
  const int a = lower.front(), b = upper.front();
  m_Height = std::sqrt((pool.space[b] - pool.space[a]).squaredNorm() - (pool.plane[b] - pool.plane[a]).squaredNorm());
  m_Limit = DepartureShare * (m_Height + std::max(m_Lower.step, m_Upper.step));
}

double
WallGuide::Departure(int below, int above) const
{
  if (m_Lower.segments.IsEmpty() || m_Upper.segments.IsEmpty())
  {
    return 0.0;
  }
  const auto key = static_cast<std::uint64_t>(below) << 32 | static_cast<std::uint32_t>(above);
  const auto known = m_Departures.find(key);
  if (known != m_Departures.end())
  {
    return known->second;
  }
  const Vector2 middle = 0.5 * (m_Pool.plane[below] + m_Pool.plane[above]);
  const Vector2 lean = 0.5 * (m_Upper.centroid - m_Lower.centroid);
  double        departure = Infinity;
  for (const Vector2 & move : { Vector2(Vector2::Zero()), lean })
  {
    const double lower = m_Lower.SignedDistance(middle - move), upper = m_Upper.SignedDistance(middle + move);
    // The interpolated distance has slope 1 in the plane and this one along the height.
    const double slope = (upper - lower) / m_Height;
    departure = std::min(departure, 0.5 * std::abs(lower + upper) / std::hypot(1.0, slope));
  }
  m_Departures.emplace(key, departure);
  return departure;
}
} // namespace tiling
} // namespace bone
