/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHalfwayLoop.h"

#include "boneContourStack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace bone
{
namespace tiling
{
namespace
{
using Polygon = std::vector<Vector2>;

constexpr int GridCells = 160; // along the longer side

struct Grid
{
  Vector2             origin;
  double              step;
  int                 nx, ny;
  std::vector<double> value;

  double &
  At(int i, int j)
  {
    return value[static_cast<std::size_t>(j) * nx + i];
  }
};

/** Signed distance to a polygon, negative inside. */
double
SignedDistance(const Vector2 & q, const Polygon & polygon)
{
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vector2 & a = polygon[i];
    const Vector2   d = polygon[(i + 1) % polygon.size()] - a;
    const double    t = std::clamp((q - a).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
    best = std::min(best, (q - a - t * d).squaredNorm());
  }
  return PointInPolygon(q, polygon) ? -std::sqrt(best) : std::sqrt(best);
}

/** Closed polygons of the zero level, material (negative) on the left. */
std::vector<Polygon>
ZeroLevel(Grid & grid)
{
  // Each crossed grid edge is a vertex, named by its lower left node and direction (0 along x, 1 along y).
  using Key = std::array<int, 3>;
  std::map<Key, Key> next;
  const auto         inside = [&grid](int i, int j) { return grid.At(i, j) < 0; };
  for (int j = 0; j + 1 < grid.ny; ++j)
  {
    for (int i = 0; i + 1 < grid.nx; ++i)
    {
      const std::array<bool, 4> in{ inside(i, j), inside(i + 1, j), inside(i + 1, j + 1), inside(i, j + 1) };
      const std::array<Key, 4>  edge{ Key{ i, j, 0 }, Key{ i + 1, j, 1 }, Key{ i, j + 1, 0 }, Key{ i, j, 1 } };
      // Walking the cell's corners counter-clockwise, the level enters where we leave the material and ends at the
      // edge by which we came in; at a saddle the material's corners stay apart.
      for (int k = 0; k < 4; ++k)
      {
        if (in[k] && !in[(k + 1) % 4])
        {
          int back = k;
          while (in[(back + 3) % 4])
          {
            back = (back + 3) % 4;
          }
          next[edge[k]] = edge[(back + 3) % 4];
        }
      }
    }
  }
  const auto place = [&grid](const Key & key) {
    const int    i = key[0], j = key[1];
    const double a = grid.At(i, j), b = key[2] == 0 ? grid.At(i + 1, j) : grid.At(i, j + 1);
    const double t = a / (a - b);
    return Vector2(grid.origin + grid.step * Vector2(i + (key[2] == 0 ? t : 0.0), j + (key[2] == 1 ? t : 0.0)));
  };
  std::vector<Polygon> polygons;
  while (!next.empty())
  {
    Polygon polygon;
    Key     key = next.begin()->first;
    for (auto it = next.find(key); it != next.end(); it = next.find(key))
    {
      polygon.push_back(place(key));
      key = it->second;
      next.erase(it);
    }
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

Polygon
ResampleClosed(const Polygon & polygon, double spacing)
{
  double length = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    length += (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
  }
  const int   count = std::max(6, static_cast<int>(std::lround(length / spacing)));
  Polygon     result;
  std::size_t segment = 0;
  double      before = 0.0, size = (polygon[1] - polygon[0]).norm();
  for (int s = 0; s < count; ++s)
  {
    const double target = length * s / count;
    while (before + size < target && segment + 1 < polygon.size())
    {
      before += size;
      ++segment;
      size = (polygon[(segment + 1) % polygon.size()] - polygon[segment]).norm();
    }
    const double t = size > 0 ? (target - before) / size : 0.0;
    result.push_back((1 - t) * polygon[segment] + t * polygon[(segment + 1) % polygon.size()]);
  }
  return result;
}

/** Where the distances to two polygons, one inside the other, are equal. */
std::vector<Polygon>
MeanLevel(const Polygon & outer, const Polygon & inner)
{
  Vector2 low = outer.front(), high = low;
  for (const Vector2 & q : outer)
  {
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  Grid grid;
  grid.step = std::max((high - low).maxCoeff() / GridCells, 1e-3);
  grid.origin = low - 2 * grid.step * Vector2::Ones();
  grid.nx = static_cast<int>(std::ceil((high - low).x() / grid.step)) + 5;
  grid.ny = static_cast<int>(std::ceil((high - low).y() / grid.step)) + 5;
  grid.value.resize(static_cast<std::size_t>(grid.nx) * grid.ny);
  for (int j = 0; j < grid.ny; ++j)
  {
    for (int i = 0; i < grid.nx; ++i)
    {
      const Vector2 q = grid.origin + grid.step * Vector2(i, j);
      double        value = SignedDistance(q, outer) + SignedDistance(q, inner);
      grid.At(i, j) = value == 0.0 ? 1e-9 : value;
    }
  }
  return ZeroLevel(grid);
}
} // namespace

std::vector<Vector2>
HalfwayLoop(const std::vector<Vector2> & outer, const std::vector<Vector2> & hole)
{
  Polygon loop;
  for (const Polygon & level : MeanLevel(outer, hole))
  {
    if (SignedArea(level) > 0 && PointInPolygon(hole.front(), level))
    {
      loop = level;
    }
  }
  if (loop.empty())
  {
    return loop;
  }
  double length = 0.0;
  for (const Polygon * polygon : { &outer, &hole })
  {
    for (std::size_t i = 0; i < polygon->size(); ++i)
    {
      length += ((*polygon)[(i + 1) % polygon->size()] - (*polygon)[i]).norm();
    }
  }
  return ResampleClosed(loop, length / static_cast<double>(outer.size() + hole.size()));
}
} // namespace tiling
} // namespace bone
