/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlanarCrossing.h"

#include "bonePredicates.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace bone
{
namespace
{
struct Edge
{
  Vector2     a;
  Vector2     b;
  std::size_t chain;
  std::size_t index;  // of the edge in its chain
  std::size_t next;   // index of the edge that starts at b; itself where there is none
  bool        closed; // false: part of an axis
};

// Whether x, known to be collinear with a and b, lies on the closed segment between them.
bool
OnSegment(const Vector2 & x, const Vector2 & a, const Vector2 & b)
{
  return std::min(a.x(), b.x()) <= x.x() && x.x() <= std::max(a.x(), b.x()) && std::min(a.y(), b.y()) <= x.y() &&
         x.y() <= std::max(a.y(), b.y());
}

bool
SegmentsMeet(const Edge & e, const Edge & f)
{
  const int ea = Orient2D(e.a, e.b, f.a);
  const int eb = Orient2D(e.a, e.b, f.b);
  const int fa = Orient2D(f.a, f.b, e.a);
  const int fb = Orient2D(f.a, f.b, e.b);
  if (ea * eb < 0 && fa * fb < 0)
  {
    return true;
  }
  return (ea == 0 && OnSegment(f.a, e.a, e.b)) || (eb == 0 && OnSegment(f.b, e.a, e.b)) ||
         (fa == 0 && OnSegment(e.a, f.a, f.b)) || (fb == 0 && OnSegment(e.b, f.a, f.b));
}

// Consecutive edges e, f meet in e.b = f.a; they do more than that where f runs back along e.
bool
FoldsBack(const Edge & e, const Edge & f)
{
  return Orient2D(e.a, e.b, f.b) == 0 && (OnSegment(f.b, e.a, e.b) || OnSegment(e.a, f.a, f.b));
}

bool
EdgesConflict(const Edge & e, const Edge & f)
{
  if (!e.closed && !f.closed)
  {
    return false; // branches of an axis share points
  }
  if (e.chain == f.chain && e.next == f.index)
  {
    return FoldsBack(e, f) || (f.next == e.index && FoldsBack(f, e));
  }
  if (e.chain == f.chain && f.next == e.index)
  {
    return FoldsBack(f, e);
  }
  return SegmentsMeet(e, f);
}

// Pairs of edges that share a cell of a grid whose cells are about as large as an edge is long.
class EdgeGrid
{
public:
  explicit EdgeGrid(const std::vector<Edge> & edges)
    : m_Edges(edges)
  {
    double  length = 0.0;
    Vector2 upper = edges.front().a;
    m_Lower = upper;
    for (const Edge & e : edges)
    {
      length += (e.b - e.a).norm();
      m_Lower = m_Lower.cwiseMin(e.a).cwiseMin(e.b);
      upper = upper.cwiseMax(e.a).cwiseMax(e.b);
    }
    const double extent = (upper - m_Lower).maxCoeff();
    m_Cell = std::max({ length / edges.size(), extent / 4096.0, 1e-300 });
    for (std::size_t i = 0; i < edges.size(); ++i)
    {
      this->Insert(i);
    }
    std::sort(m_Entries.begin(), m_Entries.end());
  }

  // The first conflicting pair in a fixed order, or false.
  bool
  FindConflict(std::size_t & first, std::size_t & second) const
  {
    for (std::size_t begin = 0, end = 0; begin < m_Entries.size(); begin = end)
    {
      while (end < m_Entries.size() && m_Entries[end].first == m_Entries[begin].first)
      {
        ++end;
      }
      for (std::size_t i = begin; i < end; ++i)
      {
        for (std::size_t j = i + 1; j < end; ++j)
        {
          first = m_Entries[i].second;
          second = m_Entries[j].second;
          if (EdgesConflict(m_Edges[first], m_Edges[second]))
          {
            return true;
          }
        }
      }
    }
    return false;
  }

private:
  std::int64_t
  CellOf(double x, double lower) const
  {
    return static_cast<std::int64_t>(std::floor((x - lower) / m_Cell));
  }

  void
  Insert(std::size_t i)
  {
    const Edge &       e = m_Edges[i];
    const std::int64_t i0 = CellOf(std::min(e.a.x(), e.b.x()), m_Lower.x());
    const std::int64_t i1 = CellOf(std::max(e.a.x(), e.b.x()), m_Lower.x());
    const std::int64_t j0 = CellOf(std::min(e.a.y(), e.b.y()), m_Lower.y());
    const std::int64_t j1 = CellOf(std::max(e.a.y(), e.b.y()), m_Lower.y());
    for (std::int64_t cx = i0; cx <= i1; ++cx)
    {
      // Rows that the edge passes in this column of cells, one more on each side against rounding.
      std::int64_t low = j0;
      std::int64_t high = j1;
      if (i1 > i0 && j1 > j0)
      {
        const double x0 = m_Lower.x() + cx * m_Cell;
        const double slope = (e.b.y() - e.a.y()) / (e.b.x() - e.a.x());
        const double ya = e.a.y() + slope * (x0 - e.a.x());
        const double yb = ya + slope * m_Cell;
        low = std::max(j0, CellOf(std::min(ya, yb), m_Lower.y()) - 1);
        high = std::min(j1, CellOf(std::max(ya, yb), m_Lower.y()) + 1);
      }
      for (std::int64_t cy = low; cy <= high; ++cy)
      {
        m_Entries.emplace_back(cx * 8192 + cy, i);
      }
    }
  }

  const std::vector<Edge> &                         m_Edges;
  Vector2                                           m_Lower;
  double                                            m_Cell{ 1.0 };
  std::vector<std::pair<std::int64_t, std::size_t>> m_Entries;
};

void
AppendEdges(const PlanarChain & chain, std::size_t c, std::vector<Edge> & edges)
{
  const std::size_t n = chain.points.size();
  const std::size_t count = chain.closed ? n : n - std::min<std::size_t>(n, 1);
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::size_t next = !chain.closed && i + 1 == count ? i : (i + 1) % count;
    edges.push_back({ chain.points[i], chain.points[(i + 1) % n], c, i, next, chain.closed });
  }
}
} // namespace

PlanarCrossing
FindPlanarCrossing(const std::vector<PlanarChain> & chains)
{
  std::vector<Edge> edges;
  for (std::size_t c = 0; c < chains.size(); ++c)
  {
    AppendEdges(chains[c], c, edges);
  }
  PlanarCrossing result;
  std::size_t    first = 0;
  std::size_t    second = 0;
  if (!edges.empty() && EdgeGrid(edges).FindConflict(first, second))
  {
    result.found = true;
    result.chain[0] = edges[first].chain;
    result.chain[1] = edges[second].chain;
    result.edge[0] = edges[first].index;
    result.edge[1] = edges[second].index;
  }
  return result;
}
} // namespace bone
