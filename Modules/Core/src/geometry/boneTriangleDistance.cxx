/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTriangleDistance.h"

#include <itkMacro.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace bone
{
namespace
{
/** An edge as its triangle walks it: from low to high id or back. */
struct HalfEdge
{
  IdType low;
  IdType high;
  bool   forward;
  IdType triangle;
  int    side;
};

std::vector<HalfEdge>
SortedHalfEdges(const std::vector<TriangleDistance::Triangle> & triangles)
{
  std::vector<HalfEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
  {
    for (int i = 0; i < 3; ++i)
    {
      const IdType a = triangles[t][i];
      const IdType b = triangles[t][(i + 1) % 3];
      edges.push_back({ std::min(a, b), std::max(a, b), a < b, static_cast<IdType>(t), i });
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge & a, const HalfEdge & b) {
    return std::tie(a.low, a.high, a.triangle, a.side) < std::tie(b.low, b.high, b.triangle, b.side);
  });
  return edges;
}
} // namespace

TriangleDistance::TriangleDistance(const std::vector<Vector3> & points, std::vector<Triangle> triangles)
  : m_Points(points)
  , m_Triangles(std::move(triangles))
{
  this->Verify();
  this->Orient();
  this->ComputeNormals();
  std::vector<TriangleTree::Triangle> corners;
  corners.reserve(m_Triangles.size());
  for (const Triangle & t : m_Triangles)
  {
    corners.push_back({ { m_Points[t[0]], m_Points[t[1]], m_Points[t[2]] } });
  }
  m_Tree = TriangleTree(std::move(corners));
}

void
TriangleDistance::Verify() const
{
  if (m_Triangles.size() < 4)
  {
    itkGenericExceptionMacro("A closed surface has at least four triangles, but there are " << m_Triangles.size()
                                                                                            << ".");
  }
  for (std::size_t p = 0; p < m_Points.size(); ++p)
  {
    if (!m_Points[p].allFinite())
    {
      itkGenericExceptionMacro("Point " << p << " of the surface is not finite.");
    }
  }
  const auto count = static_cast<IdType>(m_Points.size());
  for (std::size_t t = 0; t < m_Triangles.size(); ++t)
  {
    const Triangle & v = m_Triangles[t];
    if (*std::min_element(v.begin(), v.end()) < 0 || *std::max_element(v.begin(), v.end()) >= count)
    {
      itkGenericExceptionMacro("Triangle " << t << " of the surface names a point that is not there (there are "
                                           << count << ").");
    }
    if (!((m_Points[v[1]] - m_Points[v[0]]).cross(m_Points[v[2]] - m_Points[v[0]]).norm() > 0.0))
    {
      itkGenericExceptionMacro("Triangle " << t << " of the surface has no area; remove such triangles first.");
    }
  }
  const auto  edges = SortedHalfEdges(m_Triangles);
  std::size_t bad = 0;
  for (std::size_t e = 0; e < edges.size();)
  {
    std::size_t end = e + 1;
    while (end < edges.size() && edges[end].low == edges[e].low && edges[end].high == edges[e].high)
    {
      ++end;
    }
    bad += end - e == 2 && edges[e].forward != edges[e + 1].forward ? 0 : 1;
    e = end;
  }
  if (bad > 0)
  {
    itkGenericExceptionMacro("The surface is not closed and oriented: "
                             << bad << " edges are not shared by two triangles in opposite directions.");
  }
}

void
TriangleDistance::Orient()
{
  const Vector3 origin = m_Points[m_Triangles[0][0]];
  m_Volume = 0.0;
  for (const Triangle & t : m_Triangles)
  {
    m_Volume += (m_Points[t[0]] - origin).cross(m_Points[t[1]] - origin).dot(m_Points[t[2]] - origin) / 6.0;
  }
  if (m_Volume < 0.0)
  {
    m_Volume = -m_Volume;
    for (Triangle & t : m_Triangles)
    {
      std::swap(t[1], t[2]);
    }
  }
}

void
TriangleDistance::ComputeNormals()
{
  m_FaceNormals.resize(m_Triangles.size());
  m_EdgeNormals.resize(m_Triangles.size());
  m_PointNormals.assign(m_Points.size(), Vector3::Zero());
  for (std::size_t t = 0; t < m_Triangles.size(); ++t)
  {
    const Triangle & v = m_Triangles[t];
    m_FaceNormals[t] = (m_Points[v[1]] - m_Points[v[0]]).cross(m_Points[v[2]] - m_Points[v[0]]).normalized();
    for (int i = 0; i < 3; ++i)
    {
      const Vector3 a = m_Points[v[(i + 1) % 3]] - m_Points[v[i]];
      const Vector3 b = m_Points[v[(i + 2) % 3]] - m_Points[v[i]];
      m_PointNormals[v[i]] += std::atan2(a.cross(b).norm(), a.dot(b)) * m_FaceNormals[t];
    }
  }
  const auto edges = SortedHalfEdges(m_Triangles);
  for (std::size_t e = 0; e + 1 < edges.size(); e += 2)
  {
    const HalfEdge & a = edges[e];
    const HalfEdge & b = edges[e + 1];
    const Vector3    normal = m_FaceNormals[a.triangle] + m_FaceNormals[b.triangle];
    m_EdgeNormals[a.triangle][a.side] = normal;
    m_EdgeNormals[b.triangle][b.side] = normal;
  }
}

TriangleDistance::Nearest
TriangleDistance::FindNearest(const Vector3 & x) const
{
  const TriangleTree::Nearest found = m_Tree.FindNearest(x);
  const Triangle &            v = m_Triangles[found.triangle];

  // The feature that the nearest point lies on. Near an edge within rounding the edge's normal is right as well.
  constexpr double tolerance = 1e-7;
  Vector3          normal = m_FaceNormals[found.triangle];
  for (int i = 0; i < 3; ++i)
  {
    const Vector3 & a = m_Points[v[i]];
    const Vector3   edge = m_Points[v[(i + 1) % 3]] - a;
    const double    height = edge.cross(m_Points[v[(i + 2) % 3]] - a).norm();
    if (edge.cross(found.point - a).norm() <= tolerance * height)
    {
      normal = m_EdgeNormals[found.triangle][i];
    }
  }
  for (const IdType p : v)
  {
    if ((found.point - m_Points[p]).squaredNorm() <= 1e-20 * (1.0 + m_Points[p].squaredNorm()))
    {
      normal = m_PointNormals[p];
    }
  }
  const Vector3 offset = x - found.point;
  const double  length = std::sqrt(found.squaredDistance);
  const double  sign = offset.dot(normal) < 0.0 ? -1.0 : 1.0;
  const Vector3 gradient = length > 1e-9 ? Vector3(sign / length * offset) : Vector3(normal.normalized());
  return { sign * length, found.point, gradient, found.triangle };
}
} // namespace bone
