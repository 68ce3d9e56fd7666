/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneConstrainedTriangulation.h"

#include "bonePredicates.h"

#include <stdexcept>

namespace bone
{
namespace tiling
{
namespace
{
constexpr int
Next(int i)
{
  return (i + 1) % 3;
}

constexpr int
Previous(int i)
{
  return (i + 2) % 3;
}
} // namespace

ConstrainedTriangulation::ConstrainedTriangulation(const Vector2 & lowest, const Vector2 & highest)
  : m_Points{ lowest, { highest.x(), lowest.y() }, highest, { lowest.x(), highest.y() } }
  , m_TriangleOf{ 0, 0, 0, 1 }
{
  Triangle lower, upper;
  lower.vertices = { { 0, 1, 2 } };
  lower.neighbors = { { -1, 1, -1 } };
  upper.vertices = { { 0, 2, 3 } };
  upper.neighbors = { { -1, -1, 0 } };
  m_Triangles = { lower, upper };
}

int
ConstrainedTriangulation::IndexOf(int t, int vertex) const
{
  const auto & v = m_Triangles[t].vertices;
  return v[0] == vertex ? 0 : v[1] == vertex ? 1 : v[2] == vertex ? 2 : -1;
}

void
ConstrainedTriangulation::Link(int t, int i, int neighbor, int old)
{
  m_Triangles[t].neighbors[i] = neighbor;
  if (neighbor >= 0)
  {
    for (int & n : m_Triangles[neighbor].neighbors)
    {
      if (n == old)
      {
        n = t;
        return;
      }
    }
  }
}

int
ConstrainedTriangulation::Insert(const Vector2 & q)
{
  // A walk toward q; in a Delaunay triangulation it ends.
  int t = m_Last;
  for (bool moved = true; moved;)
  {
    moved = false;
    for (int i = 0; i < 3 && !moved; ++i)
    {
      const Triangle & here = m_Triangles[t];
      if (Orient2D(m_Points[here.vertices[Next(i)]], m_Points[here.vertices[Previous(i)]], q) < 0)
      {
        if (here.neighbors[i] < 0)
        {
          throw std::runtime_error("a point lies outside the box of its triangulation");
        }
        t = here.neighbors[i];
        moved = true;
      }
    }
  }
  m_Last = t;
  for (int v : m_Triangles[t].vertices)
  {
    if (m_Points[v] == q)
    {
      return v;
    }
  }
  const int v = static_cast<int>(m_Points.size());
  m_Points.push_back(q);
  m_TriangleOf.push_back(t);
  for (int i = 0; i < 3; ++i)
  {
    const Triangle & here = m_Triangles[t];
    if (Orient2D(m_Points[here.vertices[Next(i)]], m_Points[here.vertices[Previous(i)]], q) == 0)
    {
      SplitEdge(t, i, v);
      return v;
    }
  }
  SplitTriangle(t, v);
  return v;
}

void
ConstrainedTriangulation::SplitTriangle(int t, int v)
{
  const Triangle old = m_Triangles[t];
  const int      first = static_cast<int>(m_Triangles.size());
  const int      ids[3] = { t, first, first + 1 };
  m_Triangles.resize(m_Triangles.size() + 2);
  std::vector<std::array<int, 2>> edges;
  for (int i = 0; i < 3; ++i)
  {
    // Triangle i has v in the place of vertex i.
    Triangle & part = m_Triangles[ids[i]];
    part = old;
    part.vertices[i] = v;
    part.constrained = { { false, false, false } };
    part.constrained[i] = old.constrained[i];
    part.neighbors[Next(i)] = ids[Next(i)];
    part.neighbors[Previous(i)] = ids[Previous(i)];
    Link(ids[i], i, old.neighbors[i], t);
    edges.push_back({ { ids[i], v } });
  }
  for (int i = 0; i < 3; ++i)
  {
    m_TriangleOf[old.vertices[i]] = ids[Next(i)];
  }
  m_TriangleOf[v] = t;
  Legalize(edges);
}

void
ConstrainedTriangulation::SplitEdge(int t, int i, int v)
{
  if (m_Triangles[t].neighbors[i] < 0)
  {
    throw std::runtime_error("a point lies on the box of its triangulation");
  }
  // The flat triangle is cut off first and the edge flipped away: the split of both sides in two steps.
  const int u = m_Triangles[t].neighbors[i];
  const int a = m_Triangles[t].vertices[Next(i)], b = m_Triangles[t].vertices[Previous(i)];
  const int c = m_Triangles[t].vertices[i];
  int       j = 0;
  while (m_Triangles[u].neighbors[j] != t)
  {
    ++j;
  }
  const int      d = m_Triangles[u].vertices[j];
  const bool     fixed = m_Triangles[t].constrained[i];
  const Triangle upper = m_Triangles[t], lower = m_Triangles[u];
  const int      t2 = static_cast<int>(m_Triangles.size()), u2 = t2 + 1;
  m_Triangles.resize(m_Triangles.size() + 2);
  const auto constrainedOf = [](const Triangle & triangle, int vertex) {
    return triangle.constrained[triangle.vertices[0] == vertex ? 0 : triangle.vertices[1] == vertex ? 1 : 2];
  };
  const auto neighborOf = [](const Triangle & triangle, int vertex) {
    return triangle.neighbors[triangle.vertices[0] == vertex ? 0 : triangle.vertices[1] == vertex ? 1 : 2];
  };
  // Above a->b: (c, a, v) and (c, v, b); below: (d, b, v) and (d, v, a).
  m_Triangles[t] = { { { c, a, v } }, { { u2, t2, -1 } }, { { fixed, false, constrainedOf(upper, b) } } };
  m_Triangles[t2] = { { { c, v, b } }, { { u, -1, t } }, { { fixed, constrainedOf(upper, a), false } } };
  m_Triangles[u] = { { { d, b, v } }, { { t2, u2, -1 } }, { { fixed, false, constrainedOf(lower, a) } } };
  m_Triangles[u2] = { { { d, v, a } }, { { t, -1, u } }, { { fixed, constrainedOf(lower, b), false } } };
  Link(t, 2, neighborOf(upper, b), t);
  Link(t2, 1, neighborOf(upper, a), t);
  Link(u, 2, neighborOf(lower, a), u);
  Link(u2, 1, neighborOf(lower, b), u);
  m_TriangleOf[a] = t;
  m_TriangleOf[c] = t;
  m_TriangleOf[b] = u;
  m_TriangleOf[d] = u;
  m_TriangleOf[v] = t;
  std::vector<std::array<int, 2>> edges{ { { t, v } }, { { t2, v } }, { { u, v } }, { { u2, v } } };
  Legalize(edges);
}

bool
ConstrainedTriangulation::Flippable(int t, int i) const
{
  const int u = m_Triangles[t].neighbors[i];
  if (u < 0 || m_Triangles[t].constrained[i])
  {
    return false;
  }
  int j = 0;
  while (m_Triangles[u].neighbors[j] != t)
  {
    ++j;
  }
  const auto & p = m_Points;
  const int    a = m_Triangles[t].vertices[i], b = m_Triangles[t].vertices[Next(i)];
  const int    d = m_Triangles[t].vertices[Previous(i)], c = m_Triangles[u].vertices[j];
  return Orient2D(p[a], p[b], p[c]) > 0 && Orient2D(p[a], p[c], p[d]) > 0;
}

void
ConstrainedTriangulation::Flip(int t, int i)
{
  const int u = m_Triangles[t].neighbors[i];
  int       j = 0;
  while (m_Triangles[u].neighbors[j] != t)
  {
    ++j;
  }
  const Triangle first = m_Triangles[t], second = m_Triangles[u];
  const int      a = first.vertices[i], b = first.vertices[Next(i)], d = first.vertices[Previous(i)];
  const int      c = second.vertices[j];
  const auto     at = [](const Triangle & triangle, int vertex) {
    return triangle.vertices[0] == vertex ? 0 : triangle.vertices[1] == vertex ? 1 : 2;
  };
  // (a, b, d) and (c, d, b) become (a, b, c) and (a, c, d).
  m_Triangles[t] = { { { a, b, c } },
                     { { -1, u, -1 } },
                     { { second.constrained[at(second, d)], false, first.constrained[at(first, d)] } } };
  m_Triangles[u] = { { { a, c, d } },
                     { { -1, -1, t } },
                     { { second.constrained[at(second, b)], first.constrained[at(first, b)], false } } };
  Link(t, 0, second.neighbors[at(second, d)], u);
  Link(t, 2, first.neighbors[at(first, d)], t);
  Link(u, 0, second.neighbors[at(second, b)], u);
  Link(u, 1, first.neighbors[at(first, b)], t);
  m_TriangleOf[a] = m_TriangleOf[b] = m_TriangleOf[c] = t;
  m_TriangleOf[d] = u;
}

void
ConstrainedTriangulation::Legalize(std::vector<std::array<int, 2>> & edges)
{
  while (!edges.empty())
  {
    const auto [t, v] = edges.back();
    edges.pop_back();
    const int i = IndexOf(t, v);
    if (i < 0 || m_Triangles[t].neighbors[i] < 0 || m_Triangles[t].constrained[i])
    {
      continue;
    }
    const int u = m_Triangles[t].neighbors[i];
    int       j = 0;
    while (m_Triangles[u].neighbors[j] != t)
    {
      ++j;
    }
    const auto & w = m_Triangles[t].vertices;
    if (InCircle2D(m_Points[w[0]], m_Points[w[1]], m_Points[w[2]], m_Points[m_Triangles[u].vertices[j]]) > 0 &&
        Flippable(t, i))
    {
      Flip(t, i);
      edges.push_back({ { t, v } });
      edges.push_back({ { u, v } });
    }
  }
}

std::array<int, 2>
ConstrainedTriangulation::FindEdge(int a, int b) const
{
  // Around a, counter-clockwise, then clockwise where the box was met.
  const int start = m_TriangleOf[a];
  for (const bool forward : { true, false })
  {
    int t = start;
    do
    {
      const int i = IndexOf(t, a);
      for (int k : { Next(i), Previous(i) })
      {
        if (m_Triangles[t].vertices[k] == b)
        {
          return { { t, 3 - i - k } };
        }
      }
      t = m_Triangles[t].neighbors[forward ? Next(i) : Previous(i)];
    } while (t >= 0 && t != start);
  }
  return { { -1, -1 } };
}

void
ConstrainedTriangulation::MarkConstrained(int a, int b)
{
  const auto edge = FindEdge(a, b);
  m_Triangles[edge[0]].constrained[edge[1]] = true;
  const int u = m_Triangles[edge[0]].neighbors[edge[1]];
  if (u >= 0)
  {
    for (int j = 0; j < 3; ++j)
    {
      if (m_Triangles[u].neighbors[j] == edge[0])
      {
        m_Triangles[u].constrained[j] = true;
      }
    }
  }
}

void
ConstrainedTriangulation::Constrain(int a, int b)
{
  while (a != b && FindEdge(a, b)[0] < 0)
  {
    // The edges that the segment crosses, from a on, up to a vertex on it.
    std::vector<std::array<int, 2>> crossing;
    const Vector2 &                 pa = m_Points[a];
    const Vector2 &                 pb = m_Points[b];
    int                             t = m_TriangleOf[a], end = -1;
    for (const bool forward : { true, false })
    {
      const int start = m_TriangleOf[a];
      t = start;
      bool found = false;
      do
      {
        const int i = IndexOf(t, a);
        const int r = m_Triangles[t].vertices[Next(i)], l = m_Triangles[t].vertices[Previous(i)];
        const int right = Orient2D(pa, pb, m_Points[r]), left = Orient2D(pa, pb, m_Points[l]);
        for (const auto & [side, v] : { std::make_pair(right, r), std::make_pair(left, l) })
        {
          if (side == 0 && (m_Points[v] - pa).dot(pb - pa) > 0)
          {
            end = v;
          }
        }
        found = end >= 0 || (right < 0 && left > 0);
        if (!found)
        {
          t = m_Triangles[t].neighbors[forward ? Next(i) : Previous(i)];
        }
      } while (!found && t >= 0 && t != start);
      if (found)
      {
        break;
      }
    }
    if (end < 0)
    {
      int i = IndexOf(t, a);
      while (end < 0)
      {
        if (m_Triangles[t].constrained[i])
        {
          throw std::runtime_error("segments cross");
        }
        crossing.push_back({ { m_Triangles[t].vertices[Next(i)], m_Triangles[t].vertices[Previous(i)] } });
        const int u = m_Triangles[t].neighbors[i];
        int       j = 0;
        while (m_Triangles[u].neighbors[j] != t)
        {
          ++j;
        }
        const int apex = m_Triangles[u].vertices[j];
        const int side = Orient2D(pa, pb, m_Points[apex]);
        if (side == 0)
        {
          end = apex;
        }
        // Out through the edge whose ends lie on both sides: opposite the vertex on the apex' own side.
        const int right = crossing.back()[0];
        i = side < 0 ? IndexOf(u, right) : IndexOf(u, crossing.back()[1]);
        t = u;
      }
    }
    for (std::size_t next = 0; next < crossing.size(); ++next)
    {
      const auto [c, d] = crossing[next];
      const auto edge = FindEdge(c, d);
      if (!Flippable(edge[0], edge[1]))
      {
        crossing.push_back({ { c, d } });
        continue;
      }
      const int u = m_Triangles[edge[0]].neighbors[edge[1]];
      const int e = m_Triangles[edge[0]].vertices[edge[1]];
      Flip(edge[0], edge[1]);
      int f = -1;
      for (int v : m_Triangles[u].vertices)
      {
        f = v != e && v != c && v != d ? v : f;
      }
      if (e != a && e != end && f != a && f != end && Orient2D(pa, pb, m_Points[e]) * Orient2D(pa, pb, m_Points[f]) < 0)
      {
        crossing.push_back({ { e, f } });
      }
    }
    MarkConstrained(a, end);
    a = end;
  }
  if (a != b)
  {
    MarkConstrained(a, b);
  }
}

std::vector<char>
ConstrainedTriangulation::Inside() const
{
  std::vector<char> inside(m_Triangles.size(), -1);
  std::vector<int>  stack{ m_TriangleOf[0] };
  inside[stack[0]] = 0;
  while (!stack.empty())
  {
    const int t = stack.back();
    stack.pop_back();
    for (int i = 0; i < 3; ++i)
    {
      const int u = m_Triangles[t].neighbors[i];
      if (u >= 0 && inside[u] < 0)
      {
        inside[u] = static_cast<char>(inside[t] != static_cast<char>(m_Triangles[t].constrained[i]));
        stack.push_back(u);
      }
    }
  }
  return inside;
}
} // namespace tiling
} // namespace bone
