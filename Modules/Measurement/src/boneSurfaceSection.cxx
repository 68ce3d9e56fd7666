/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceSection.h"

#include <limits>
#include <map>
#include <stdexcept>

namespace bone
{
namespace
{
using EdgeIds = std::array<IdType, 2>;

EdgeIds
SectionEdge(IdType a, IdType b)
{
  return a < b ? EdgeIds{ a, b } : EdgeIds{ b, a };
}

void
MeasureLoop(const Vector3 & normal, SectionLoop & loop)
{
  const Vector3 origin = loop.points.front();
  Vector3       moment = Vector3::Zero();
  for (std::size_t i = 0; i < loop.points.size(); ++i)
  {
    const Vector3 a = loop.points[i] - origin, b = loop.points[(i + 1) % loop.points.size()] - origin;
    const double  area = 0.5 * normal.dot(a.cross(b));
    loop.area += area;
    moment += area / 3.0 * (a + b);
  }
  loop.centroid = loop.area != 0.0 ? Vector3(origin + moment / loop.area) : origin;
}
} // namespace

bool
SectionLoop::Holds(const Vector3 & x) const
{
  // The angle that the loop turns about x, by a plane frame of the loop.
  Vector3 normal = Vector3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    normal += (points[i] - points[0]).cross(points[(i + 1) % points.size()] - points[0]);
  }
  normal.normalize();
  double angle = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Vector3 a = points[i] - x, b = points[(i + 1) % points.size()] - x;
    angle += std::atan2(normal.dot(a.cross(b)), a.dot(b));
  }
  return angle > 3.0;
}

double
SectionLoop::Width(const Vector3 & direction) const
{
  double lower = std::numeric_limits<double>::max(), upper = -lower;
  for (const Vector3 & p : points)
  {
    lower = std::min(lower, direction.dot(p));
    upper = std::max(upper, direction.dot(p));
  }
  return upper - lower;
}

std::vector<SectionLoop>
CutSurface(const TriangleSurface & surface, const Vector3 & point, const Vector3 & normal)
{
  const auto height = [&](IdType id) { return normal.dot(surface.points[id] - point); };
  // Within a triangle that is cut, from the edge that goes down to the one that goes up: counter-clockwise about the
  // normal, seen from where that points to.
  std::map<EdgeIds, EdgeIds> next;
  std::vector<EdgeIds>       starts;
  for (const auto & t : surface.triangles)
  {
    const std::array<bool, 3> up = { height(t[0]) >= 0.0, height(t[1]) >= 0.0, height(t[2]) >= 0.0 };
    EdgeIds                   falling{ -1, -1 }, rising{ -1, -1 };
    for (int i = 0; i < 3; ++i)
    {
      const int j = (i + 1) % 3;
      if (up[i] != up[j])
      {
        (up[i] ? falling : rising) = SectionEdge(t[i], t[j]);
      }
    }
    if (falling[0] >= 0)
    {
      next[falling] = rising;
      starts.push_back(falling);
    }
  }
  std::vector<SectionLoop> loops;
  for (const EdgeIds & start : starts)
  {
    SectionLoop loop;
    EdgeIds     edge = start;
    for (auto at = next.find(edge); at != next.end(); at = next.find(edge))
    {
      const double a = height(edge[0]), b = height(edge[1]);
      loop.points.push_back(surface.points[edge[0]] +
                            a / (a - b) * (surface.points[edge[1]] - surface.points[edge[0]]));
      edge = at->second;
      next.erase(at);
    }
    if (loop.points.size() >= 3)
    {
      MeasureLoop(normal, loop);
      loops.push_back(std::move(loop));
    }
  }
  return loops;
}

SectionLoop
FindSection(const TriangleSurface & surface, const Vector3 & point, const Vector3 & normal)
{
  const SectionLoop * nearest = nullptr;
  double              least = std::numeric_limits<double>::max();
  const auto          loops = CutSurface(surface, point, normal);
  for (const SectionLoop & loop : loops)
  {
    const double distance = loop.Holds(point) ? 0.0 : (loop.centroid - point).norm();
    if (loop.area > 0.0 && distance < least)
    {
      least = distance;
      nearest = &loop;
    }
  }
  if (!nearest)
  {
    throw std::invalid_argument("The plane does not cut the bone.");
  }
  return *nearest;
}
} // namespace bone
