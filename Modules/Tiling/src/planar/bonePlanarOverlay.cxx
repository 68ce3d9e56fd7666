/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlanarOverlay.h"

#include "bonePredicates.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bone
{
namespace tiling
{
namespace
{
using Triangle = std::array<int, 3>;

constexpr int Corners = 4;

/** The triangles of a triangulation by the cells of a grid that their bounds meet. */
class TriangleGrid
{
public:
  explicit TriangleGrid(const BoxTriangulation & box)
    : m_Lowest(box.points[0])
    , m_Side(std::max(1, static_cast<int>(std::sqrt(0.5 * static_cast<double>(box.triangles.size())))))
    , m_Scale(m_Side / (box.points[2].x() - box.points[0].x()), m_Side / (box.points[2].y() - box.points[0].y()))
    , m_Cells(static_cast<std::size_t>(m_Side) * m_Side)
  {
    for (std::size_t t = 0; t < box.triangles.size(); ++t)
    {
      ForCells(box.points, box.triangles[t], [&](std::size_t cell) { m_Cells[cell].push_back(static_cast<int>(t)); });
    }
  }

  /** Triangles whose bounds meet those of a triangle, ascending. */
  void
  Find(const std::vector<Vector2> & points, const Triangle & triangle, std::vector<int> & found) const
  {
    found.clear();
    ForCells(points, triangle, [&](std::size_t cell) {
      found.insert(found.end(), m_Cells[cell].begin(), m_Cells[cell].end());
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
  }

private:
  template <typename TVisit>
  void
  ForCells(const std::vector<Vector2> & points, const Triangle & t, const TVisit & visit) const
  {
    const Vector2 low = points[t[0]].cwiseMin(points[t[1]]).cwiseMin(points[t[2]]);
    const Vector2 high = points[t[0]].cwiseMax(points[t[1]]).cwiseMax(points[t[2]]);
    const auto    at = [this](const Vector2 & q, int axis) {
      return std::clamp(static_cast<int>((q[axis] - m_Lowest[axis]) * m_Scale[axis]), 0, m_Side - 1);
    };
    for (int y = at(low, 1); y <= at(high, 1); ++y)
    {
      for (int x = at(low, 0); x <= at(high, 0); ++x)
      {
        visit(static_cast<std::size_t>(y) * m_Side + x);
      }
    }
  }

  Vector2                       m_Lowest;
  int                           m_Side;
  Vector2                       m_Scale;
  std::vector<std::vector<int>> m_Cells;
};

class Overlayer
{
public:
  Overlayer(const BoxTriangulation & first, const BoxTriangulation & second)
    : m_Boxes{ &first, &second }
  {
    for (int side = 0; side < 2; ++side)
    {
      for (std::size_t v = 0; v < m_Boxes[side]->points.size(); ++v)
      {
        const bool shared = side == 1 && v < Corners;
        m_Result.vertexOf[side].push_back(shared ? static_cast<int>(v) : static_cast<int>(m_Result.points.size()));
        if (!shared)
        {
          m_Result.points.push_back(m_Boxes[side]->points[v]);
        }
      }
    }
  }

  PlanarOverlay
  Run(const Execution & execution)
  {
    const TriangleGrid grid(*m_Boxes[1]);
    std::vector<int>   near;
    for (std::size_t t = 0; t < m_Boxes[0]->triangles.size(); ++t)
    {
      execution.ThrowIfAborted();
      grid.Find(m_Boxes[0]->points, m_Boxes[0]->triangles[t], near);
      for (int u : near)
      {
        AddCell(static_cast<int>(t), u);
      }
    }
    for (int side = 0; side < 2; ++side)
    {
      for (const auto & [edge, steps] : m_Steps[side])
      {
        MakeChain(side, edge, steps);
      }
    }
    return std::move(m_Result);
  }

private:
  /** Sign of vertex v of one triangulation against the edge a -> b of the other; 0 only at a shared corner. */
  int
  Side(int side, int a, int b, int v) const
  {
    if (v < Corners && (v == a || v == b))
    {
      return 0;
    }
    const auto & p = m_Boxes[side]->points;
    const int    sign = Orient2D(p[a], p[b], m_Boxes[1 - side]->points[v]);
    if (sign == 0 && !(v < Corners && (a < Corners || b < Corners)))
    {
      throw std::runtime_error("a vertex lies on an edge of the other triangulation");
    }
    return sign;
  }

  bool
  Inside(int side, int v, const Triangle & other) const
  {
    for (int i = 0; i < 3; ++i)
    {
      if (Side(1 - side, other[i], other[(i + 1) % 3], v) < 0)
      {
        return false;
      }
    }
    return true;
  }

  int
  Crossing(int side, const Edge & own, const Edge & other)
  {
    const Edge               a = Undirected(own[0], own[1]), b = Undirected(other[0], other[1]);
    const std::array<int, 4> key =
      side == 0 ? std::array<int, 4>{ { a[0], a[1], b[0], b[1] } } : std::array<int, 4>{ { b[0], b[1], a[0], a[1] } };
    const auto found = m_Crossings.find(key);
    if (found != m_Crossings.end())
    {
      return found->second;
    }
    const auto &  p = m_Boxes[0]->points;
    const auto &  q = m_Boxes[1]->points;
    const Vector2 d = p[key[1]] - p[key[0]], e = q[key[3]] - q[key[2]], s = q[key[2]] - p[key[0]];
    const double  t = (s.x() * e.y() - s.y() * e.x()) / (d.x() * e.y() - d.y() * e.x());
    const int     id = static_cast<int>(m_Result.points.size());
    m_Result.points.push_back(p[key[0]] + std::clamp(t, 0.0, 1.0) * d);
    m_Crossings.emplace(key, id);
    return id;
  }

  /** The part of edge a -> b that lies in a triangle of the other triangulation, as overlay vertices from, to. */
  bool
  Part(int side, int a, int b, const Triangle & other, int & from, int & to)
  {
    from = to = -1;
    // A shared corner: the edge lies inside where it runs between the two sides of the triangle there.
    for (const int corner : { a, b })
    {
      const int far = corner == a ? b : a;
      for (int i = 0; i < 3 && corner < Corners; ++i)
      {
        if (other[i] == corner)
        {
          const int  next = other[(i + 1) % 3], last = other[(i + 2) % 3];
          const bool left = (far < Corners && far == next) || Side(1 - side, corner, next, far) > 0;
          const bool right = (far < Corners && far == last) || Side(1 - side, last, corner, far) > 0;
          if (!left || !right)
          {
            return false;
          }
          (corner == a ? from : to) = m_Result.vertexOf[side][corner];
        }
      }
    }
    if (from < 0 && Inside(side, a, other))
    {
      from = m_Result.vertexOf[side][a];
    }
    if (to < 0 && Inside(side, b, other))
    {
      to = m_Result.vertexOf[side][b];
    }
    for (int i = 0; i < 3 && (from < 0 || to < 0); ++i)
    {
      const int c = other[i], d = other[(i + 1) % 3];
      // Edges that meet in a shared corner do not cross.
      if ((a < Corners && (a == c || a == d)) || (b < Corners && (b == c || b == d)))
      {
        continue;
      }
      const int sa = Side(1 - side, c, d, a), sb = Side(1 - side, c, d, b);
      if (sa * sb < 0 && Side(side, a, b, c) * Side(side, a, b, d) < 0)
      {
        (sa < 0 ? from : to) = Crossing(side, { { a, b } }, { { c, d } });
      }
    }
    return from >= 0 && to >= 0 && from != to;
  }

  void
  AddCell(int t, int u)
  {
    const Triangle     triangles[2] = { m_Boxes[0]->triangles[t], m_Boxes[1]->triangles[u] };
    std::map<int, int> next;
    for (int side = 0; side < 2; ++side)
    {
      for (int i = 0; i < 3; ++i)
      {
        const int a = triangles[side][i], b = triangles[side][(i + 1) % 3];
        int       from, to;
        if (Part(side, a, b, triangles[1 - side], from, to))
        {
          next[from] = to;
          const bool forward = a < b;
          m_Steps[side][Undirected(a, b)][forward ? from : to] = forward ? to : from;
        }
      }
    }
    if (next.size() < 3)
    {
      return;
    }
    std::vector<int> polygon{ next.begin()->first };
    while (polygon.size() <= next.size())
    {
      const auto at = next.find(polygon.back());
      if (at == next.end())
      {
        throw std::runtime_error("the cells of two triangulations do not close");
      }
      if (at->second == polygon.front())
      {
        break;
      }
      polygon.push_back(at->second);
    }
    if (polygon.size() != next.size())
    {
      throw std::runtime_error("the cells of two triangulations do not close");
    }
    Triangulate(polygon, t, u);
  }

  /** A fan of a convex polygon from the corner that makes the fattest triangles. */
  void
  Triangulate(const std::vector<int> & polygon, int t, int u)
  {
    const std::size_t n = polygon.size();
    const auto &      p = m_Result.points;
    std::size_t       best = n;
    double            bestShape = 0.0;
    for (std::size_t apex = 0; apex < n; ++apex)
    {
      double shape = 1.0;
      for (std::size_t k = 1; k + 1 < n && shape > 0; ++k)
      {
        const Vector2 &a = p[polygon[apex]], &b = p[polygon[(apex + k) % n]], &c = p[polygon[(apex + k + 1) % n]];
        const Vector2  d = b - a, e = c - a;
        const double   longest = std::max({ d.squaredNorm(), e.squaredNorm(), (c - b).squaredNorm() });
        shape = Orient2D(a, b, c) > 0 ? std::min(shape, (d.x() * e.y() - d.y() * e.x()) / longest) : 0.0;
      }
      if (shape > bestShape)
      {
        bestShape = shape;
        best = apex;
      }
    }
    if (best == n)
    {
      throw std::runtime_error("a cell of two triangulations is too thin");
    }
    for (std::size_t k = 1; k + 1 < n; ++k)
    {
      m_Result.triangles.push_back(
        { { { polygon[best], polygon[(best + k) % n], polygon[(best + k + 1) % n] } }, t, u });
    }
  }

  void
  MakeChain(int side, const Edge & edge, const std::map<int, int> & steps)
  {
    std::vector<int> & chain = m_Result.chains[side][edge];
    const int          end = m_Result.vertexOf[side][edge[1]];
    chain = { m_Result.vertexOf[side][edge[0]] };
    while (chain.back() != end)
    {
      const auto step = steps.find(chain.back());
      if (step == steps.end() || chain.size() > steps.size())
      {
        throw std::runtime_error("an edge is not covered by the cells of two triangulations");
      }
      chain.push_back(step->second);
    }
  }

  const BoxTriangulation *           m_Boxes[2];
  PlanarOverlay                      m_Result;
  std::map<std::array<int, 4>, int>  m_Crossings;
  std::map<Edge, std::map<int, int>> m_Steps[2];
};
} // namespace

PlanarOverlay
Overlay(const BoxTriangulation & first, const BoxTriangulation & second, const Execution & execution)
{
  return Overlayer(first, second).Run(execution);
}
} // namespace tiling
} // namespace bone
