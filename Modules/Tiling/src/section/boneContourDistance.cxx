/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourDistance.h"

#include <cmath>

namespace bone
{
namespace tiling
{
ContourDistance::ContourDistance(const std::vector<Vector2> & polygon, const Vector2 & move)
{
  std::vector<TriangleTree::Triangle> segments;
  for (const Vector2 & q : polygon)
  {
    m_Polygon.emplace_back(q + move);
  }
  for (std::size_t i = 0; i < m_Polygon.size(); ++i)
  {
    const Vector2 &from = m_Polygon[i], &to = m_Polygon[(i + 1) % m_Polygon.size()];
    segments.push_back({ { Vector3(from.x(), from.y(), 0), Vector3(to.x(), to.y(), 0), Vector3(to.x(), to.y(), 0) } });
  }
  m_Segments = TriangleTree(std::move(segments));
}

double
ContourDistance::At(const Vector2 & q) const
{
  bool inside = false;
  for (std::size_t i = 0; i < m_Polygon.size(); ++i)
  {
    const Vector2 &a = m_Polygon[i], &b = m_Polygon[(i + 1) % m_Polygon.size()];
    if ((a.y() > q.y()) != (b.y() > q.y()) && q.x() < a.x() + (q.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
    {
      inside = !inside;
    }
  }
  const double distance = std::sqrt(m_Segments.FindNearest(Vector3(q.x(), q.y(), 0)).squaredDistance);
  return inside ? -distance : distance;
}
} // namespace tiling
} // namespace bone
