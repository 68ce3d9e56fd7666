/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneChordalAxis.h"

#include "boneContourStack.h"
#include "bonePredicates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace bone
{
namespace tiling
{
namespace
{
using Triangle = std::array<int, 3>;

bool
InTriangle(const Vector2 & q, const Vector2 & a, const Vector2 & b, const Vector2 & c)
{
  return Orient2D(a, b, q) >= 0 && Orient2D(b, c, q) >= 0 && Orient2D(c, a, q) >= 0;
}

/** Ear clipping; empty where no ear is left (the polygon crosses itself). */
std::vector<Triangle>
ClipEars(const std::vector<Vector2> & p)
{
  std::vector<int> ring(p.size());
  std::iota(ring.begin(), ring.end(), 0);
  std::vector<Triangle> triangles;
  while (ring.size() > 3)
  {
    const std::size_t n = ring.size();
    std::size_t       ear = n;
    double            bestAngle = -2.0;
    for (std::size_t i = 0; i < n; ++i)
    {
      const int a = ring[(i + n - 1) % n], b = ring[i], c = ring[(i + 1) % n];
      if (Orient2D(p[a], p[b], p[c]) <= 0)
      {
        continue;
      }
      const double angle = (p[a] - p[b]).normalized().dot((p[c] - p[b]).normalized());
      if (angle <= bestAngle)
      {
        continue;
      }
      const bool empty = std::none_of(ring.begin(), ring.end(), [&](int v) {
        return v != a && v != b && v != c && InTriangle(p[v], p[a], p[b], p[c]);
      });
      if (empty)
      {
        ear = i;
        bestAngle = angle;
      }
    }
    if (ear == n)
    {
      return {};
    }
    triangles.push_back({ ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n] });
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  if (Orient2D(p[ring[0]], p[ring[1]], p[ring[2]]) <= 0)
  {
    return {};
  }
  triangles.push_back({ ring[0], ring[1], ring[2] });
  return triangles;
}

/** Lawson's flips to the constrained Delaunay triangulation. */
void
FlipToDelaunay(const std::vector<Vector2> & p, std::vector<Triangle> & triangles)
{
  std::map<Edge, int> owner; // directed edge -> triangle
  const auto          enter = [&](int t) {
    for (int k = 0; k < 3; ++k)
    {
      owner[{ triangles[t][k], triangles[t][(k + 1) % 3] }] = t;
    }
  };
  std::vector<Edge> stack;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
  {
    enter(t);
    for (int k = 0; k < 3; ++k)
    {
      stack.push_back({ triangles[t][k], triangles[t][(k + 1) % 3] });
    }
  }
  const auto opposite = [&](int t, const Edge & e) {
    for (int v : triangles[t])
    {
      if (v != e[0] && v != e[1])
      {
        return v;
      }
    }
    return -1;
  };
  while (!stack.empty())
  {
    const Edge e = stack.back();
    stack.pop_back();
    const auto left = owner.find(e), right = owner.find({ { e[1], e[0] } });
    if (left == owner.end() || right == owner.end())
    {
      continue;
    }
    const int t = left->second, u = right->second;
    const int c = opposite(t, e), d = opposite(u, e);
    const int a = e[0], b = e[1];
    if (InCircle2D(p[a], p[b], p[c], p[d]) <= 0 || Orient2D(p[a], p[d], p[c]) <= 0 || Orient2D(p[d], p[b], p[c]) <= 0)
    {
      continue;
    }
    owner.erase({ { a, b } });
    owner.erase({ { b, a } });
    triangles[t] = { a, d, c };
    triangles[u] = { d, b, c };
    enter(t);
    enter(u);
    for (const Edge & next : { Edge{ { a, d } }, Edge{ { d, b } }, Edge{ { b, c } }, Edge{ { c, a } } })
    {
      stack.push_back(next);
    }
  }
}

std::vector<std::vector<int>>
Adjacency(const PlanarTree & tree)
{
  std::vector<std::vector<int>> neighbors(tree.points.size());
  for (const auto & e : tree.edges)
  {
    neighbors[e[0]].push_back(e[1]);
    neighbors[e[1]].push_back(e[0]);
  }
  return neighbors;
}

double
DistanceToPolygon(const Vector2 & q, const std::vector<Vector2> & polygon)
{
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vector2 & a = polygon[i];
    const Vector2   d = polygon[(i + 1) % polygon.size()] - a;
    const double    t = std::clamp((q - a).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
    best = std::min(best, (q - a - t * d).norm());
  }
  return best;
}

/** The branch from a leaf to the next vertex of degree other than 2, leaf first. */
std::vector<int>
LeafBranch(const std::vector<std::vector<int>> & neighbors, int leaf)
{
  std::vector<int> branch{ leaf };
  int              previous = -1, here = leaf;
  for (;;)
  {
    int next = -1;
    for (int v : neighbors[here])
    {
      if (v != previous)
      {
        next = v;
        break;
      }
    }
    if (next < 0)
    {
      return branch;
    }
    branch.push_back(next);
    if (neighbors[next].size() != 2)
    {
      return branch;
    }
    previous = here;
    here = next;
  }
}

double
Length(const PlanarTree & tree, const std::vector<int> & path)
{
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i)
  {
    length += (tree.points[path[i]] - tree.points[path[i - 1]]).norm();
  }
  return length;
}

/** Removes vertices flagged dead, with their edges. */
void
Compact(PlanarTree & tree, const std::vector<char> & dead)
{
  std::vector<int>     id(tree.points.size(), -1);
  std::vector<Vector2> points;
  for (std::size_t v = 0; v < tree.points.size(); ++v)
  {
    if (!dead[v])
    {
      id[v] = static_cast<int>(points.size());
      points.push_back(tree.points[v]);
    }
  }
  std::vector<std::array<int, 2>> edges;
  for (const auto & e : tree.edges)
  {
    if (id[e[0]] >= 0 && id[e[1]] >= 0)
    {
      edges.push_back({ { id[e[0]], id[e[1]] } });
    }
  }
  tree.points = std::move(points);
  tree.edges = std::move(edges);
}

/** Keeps of a tree what reaches beyond a disk: from the vertex of largest clearance, paths to leaves are added, the
 * farthest in clearances of where it leaves the kept part first, while it is more than `reach` clearances long. */
void
KeepSignificantPaths(PlanarTree & tree, const std::vector<Vector2> & polygon, double reach)
{
  const auto          neighbors = Adjacency(tree);
  const int           n = static_cast<int>(tree.points.size());
  std::vector<double> clearance(n);
  for (int v = 0; v < n; ++v)
  {
    clearance[v] = DistanceToPolygon(tree.points[v], polygon);
  }
  const int         pole = static_cast<int>(std::max_element(clearance.begin(), clearance.end()) - clearance.begin());
  std::vector<int>  parent(n, -1), order{ pole };
  std::vector<char> dead(n, 1);
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    for (int u : neighbors[order[i]])
    {
      if (u != parent[order[i]])
      {
        parent[u] = order[i];
        order.push_back(u);
      }
    }
  }
  dead[pole] = 0;
  for (;;)
  {
    // Way from the kept part, and the clearance where it leaves it, handed down the tree.
    std::vector<double> way(n, 0.0), start(clearance);
    int                 farthest = -1;
    double              most = reach;
    for (int v : order)
    {
      if (!dead[v])
      {
        continue;
      }
      way[v] = way[parent[v]] + (tree.points[v] - tree.points[parent[v]]).norm();
      start[v] = start[parent[v]];
      if (neighbors[v].size() == 1 && way[v] + clearance[v] > most * start[v])
      {
        most = (way[v] + clearance[v]) / start[v];
        farthest = v;
      }
    }
    if (farthest < 0)
    {
      break;
    }
    for (int v = farthest; dead[v]; v = parent[v])
    {
      dead[v] = 0;
    }
  }
  Compact(tree, dead);
}

/** Moves vertices of degree 2 to the middle of their neighbours, some rounds. */
void
Straighten(PlanarTree & tree)
{
  const auto neighbors = Adjacency(tree);
  for (int round = 0; round < 6; ++round)
  {
    auto moved = tree.points;
    for (std::size_t v = 0; v < tree.points.size(); ++v)
    {
      if (neighbors[v].size() == 2)
      {
        moved[v] = 0.5 * tree.points[v] + 0.25 * (tree.points[neighbors[v][0]] + tree.points[neighbors[v][1]]);
      }
    }
    tree.points = std::move(moved);
  }
}

/** Cuts each leaf branch back to where the way to its tip is `factor` times the clearance, about the centre of the
 * largest circle that fits the end of the shape: the tip itself wanders from slice to slice. */
void
TrimLeaves(PlanarTree & tree, const std::vector<Vector2> & polygon, double factor)
{
  const auto        neighbors = Adjacency(tree);
  std::vector<char> dead(tree.points.size(), 0);
  for (int leaf = 0; leaf < static_cast<int>(tree.points.size()); ++leaf)
  {
    if (neighbors[leaf].size() != 1)
    {
      continue;
    }
    const auto branch = LeafBranch(neighbors, leaf);
    double     way = DistanceToPolygon(tree.points[leaf], polygon);
    for (std::size_t i = 0; i + 1 < branch.size(); ++i)
    {
      if (dead[branch[i]] || way > 1.01 * factor * DistanceToPolygon(tree.points[branch[i]], polygon))
      {
        break;
      }
      dead[branch[i]] = 1;
      way += (tree.points[branch[i + 1]] - tree.points[branch[i]]).norm();
    }
  }
  if (std::count(dead.begin(), dead.end(), 0) > 0)
  {
    Compact(tree, dead);
  }
}

/** Appends the polyline `path` of `from`, resampled to steps of about `spacing`, keeping its ends. */
void
AppendResampled(const PlanarTree &       from,
                const std::vector<int> & path,
                double                   spacing,
                std::vector<int> &       idOfEnd,
                PlanarTree &             to)
{
  const double length = Length(from, path);
  const int    steps = std::max(1, static_cast<int>(std::lround(length / spacing)));
  const auto   endId = [&](int v) {
    if (idOfEnd[v] < 0)
    {
      idOfEnd[v] = static_cast<int>(to.points.size());
      to.points.push_back(from.points[v]);
    }
    return idOfEnd[v];
  };
  int         previous = endId(path.front());
  std::size_t segment = 1;
  double      before = 0.0;
  for (int s = 1; s < steps; ++s)
  {
    const double target = length * s / steps;
    double       size = (from.points[path[segment]] - from.points[path[segment - 1]]).norm();
    while (before + size < target && segment + 1 < path.size())
    {
      before += size;
      ++segment;
      size = (from.points[path[segment]] - from.points[path[segment - 1]]).norm();
    }
    const double t = size > 0 ? (target - before) / size : 0.0;
    to.points.push_back((1 - t) * from.points[path[segment - 1]] + t * from.points[path[segment]]);
    to.edges.push_back({ { previous, static_cast<int>(to.points.size()) - 1 } });
    previous = static_cast<int>(to.points.size()) - 1;
  }
  const int last = endId(path.back());
  to.edges.push_back({ { previous, last } });
}

PlanarTree
Resample(const PlanarTree & tree, double spacing)
{
  const auto       neighbors = Adjacency(tree);
  PlanarTree       result;
  std::vector<int> idOfEnd(tree.points.size(), -1);
  for (int v = 0; v < static_cast<int>(tree.points.size()); ++v)
  {
    if (neighbors[v].size() == 2)
    {
      continue;
    }
    for (int first : neighbors[v])
    {
      std::vector<int> path{ v, first };
      while (neighbors[path.back()].size() == 2)
      {
        const int here = path.back(), previous = path[path.size() - 2];
        path.push_back(neighbors[here][0] == previous ? neighbors[here][1] : neighbors[here][0]);
      }
      if (path.back() > v)
      {
        AppendResampled(tree, path, spacing, idOfEnd, result);
      }
    }
  }
  return result;
}

/** The point halfway along the longest path of the tree. */
Vector2
Middle(const PlanarTree & tree)
{
  const auto neighbors = Adjacency(tree);
  const auto farthest = [&](int start, std::vector<int> & parent) {
    std::vector<double> distance(tree.points.size(), -1.0);
    std::vector<int>    queue{ start };
    parent.assign(tree.points.size(), -1);
    distance[start] = 0.0;
    int best = start;
    for (std::size_t i = 0; i < queue.size(); ++i)
    {
      const int v = queue[i];
      best = distance[v] > distance[best] ? v : best;
      for (int u : neighbors[v])
      {
        if (distance[u] < 0)
        {
          distance[u] = distance[v] + (tree.points[u] - tree.points[v]).norm();
          parent[u] = v;
          queue.push_back(u);
        }
      }
    }
    return best;
  };
  std::vector<int> parent;
  const int        a = farthest(0, parent);
  const int        b = farthest(a, parent);
  std::vector<int> path;
  for (int v = b; v >= 0; v = parent[v])
  {
    path.push_back(v);
  }
  double half = Length(tree, path) / 2;
  for (std::size_t i = 1; i < path.size(); ++i)
  {
    const Vector2 d = tree.points[path[i]] - tree.points[path[i - 1]];
    if (d.norm() >= half && d.norm() > 0)
    {
      return tree.points[path[i - 1]] + d * (half / d.norm());
    }
    half -= d.norm();
  }
  return tree.points[path.back()];
}
} // namespace

std::vector<std::array<int, 3>>
TriangulatePolygon(const std::vector<Vector2> & polygon)
{
  if (polygon.size() < 3)
  {
    return {};
  }
  auto triangles = ClipEars(polygon);
  FlipToDelaunay(polygon, triangles);
  return triangles;
}

PlanarTree
ChordalAxis(const std::vector<Vector2> & polygon)
{
  const auto          triangles = TriangulatePolygon(polygon);
  const int           n = static_cast<int>(polygon.size());
  PlanarTree          tree;
  std::map<Edge, int> midpoint;
  const auto          isBoundary = [n](int a, int b) { return (a + 1) % n == b || (b + 1) % n == a; };
  for (const Triangle & t : triangles)
  {
    std::vector<int> inner;
    for (int k = 0; k < 3; ++k)
    {
      const int a = t[k], b = t[(k + 1) % 3];
      if (isBoundary(a, b))
      {
        continue;
      }
      const auto [it, fresh] = midpoint.insert({ Undirected(a, b), static_cast<int>(tree.points.size()) });
      if (fresh)
      {
        tree.points.push_back(0.5 * (polygon[a] + polygon[b]));
      }
      inner.push_back(it->second);
    }
    if (inner.size() == 2)
    {
      tree.edges.push_back({ { inner[0], inner[1] } });
    }
    else if (inner.size() == 3)
    {
      const int centre = static_cast<int>(tree.points.size());
      tree.points.push_back((polygon[t[0]] + polygon[t[1]] + polygon[t[2]]) / 3.0);
      for (int m : inner)
      {
        tree.edges.push_back({ { m, centre } });
      }
    }
  }
  if (tree.points.empty() && !triangles.empty())
  {
    const Triangle & t = triangles.front();
    tree.points.push_back((polygon[t[0]] + polygon[t[1]] + polygon[t[2]]) / 3.0);
  }
  return tree;
}

PlanarTree
SimplifyAxis(const PlanarTree & axis, const std::vector<Vector2> & polygon, double factor, double spacing)
{
  if (axis.edges.empty())
  {
    return axis;
  }
  PlanarTree tree = axis;
  KeepSignificantPaths(tree, polygon, 1.0 + factor);
  if (tree.edges.empty())
  {
    return tree;
  }
  TrimLeaves(tree, polygon, factor);
  double length = 0.0;
  for (const auto & e : tree.edges)
  {
    length += (tree.points[e[0]] - tree.points[e[1]]).norm();
  }
  const Vector2 middle = Middle(tree);
  if (length < 0.5 * factor * DistanceToPolygon(middle, polygon))
  {
    return PlanarTree{ { middle }, {} };
  }
  Straighten(tree);
  return Resample(tree, spacing);
}

PlanarTree
TreeOfWalk(const std::vector<Vector2> & plane, const Walk & walk)
{
  PlanarTree         tree;
  std::map<int, int> ids;
  const auto         idOf = [&](int v) {
    const auto [it, fresh] = ids.insert({ v, static_cast<int>(tree.points.size()) });
    if (fresh)
    {
      tree.points.push_back(plane[v]);
    }
    return it->second;
  };
  for (std::size_t i = 0; i < walk.size(); ++i)
  {
    const int a = idOf(walk[i]), b = idOf(walk[(i + 1) % walk.size()]);
    if (a < b)
    {
      tree.edges.push_back({ { a, b } });
    }
  }
  return tree;
}

PlanarTree
CarryAxis(const PlanarTree & tree, const PlanarTree & target, const std::vector<Vector2> & polygon, double leastEdge)
{
  constexpr double  pull = 0.35;
  constexpr double  leastClearance = 0.3; // of the largest on the tree
  PlanarTree        carried = tree;
  std::vector<char> dead(tree.points.size(), 0);
  double            largest = 0.0;
  for (Vector2 & q : carried.points)
  {
    Vector2 nearest = target.points.front();
    for (const auto & e : target.edges)
    {
      const Vector2 & a = target.points[e[0]];
      const Vector2   d = target.points[e[1]] - a;
      const Vector2   x = a + std::clamp((q - a).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0) * d;
      nearest = (x - q).squaredNorm() < (nearest - q).squaredNorm() ? x : nearest;
    }
    q += pull * (nearest - q);
    largest = std::max(largest, PointInPolygon(q, polygon) ? DistanceToPolygon(q, polygon) : 0.0);
  }
  for (std::size_t v = 0; v < carried.points.size(); ++v)
  {
    const Vector2 & q = carried.points[v];
    dead[v] = !PointInPolygon(q, polygon) || DistanceToPolygon(q, polygon) < leastClearance * largest;
  }
  Compact(carried, dead);
  const bool squeezed = std::any_of(carried.edges.begin(), carried.edges.end(), [&](const std::array<int, 2> & e) {
    return (carried.points[e[0]] - carried.points[e[1]]).norm() < leastEdge;
  });
  return carried.points.size() == carried.edges.size() + 1 && !squeezed ? carried : PlanarTree{};
}

Walk
TreeWalk(const PlanarTree & tree, const std::vector<int> & vertexOf)
{
  if (tree.edges.empty())
  {
    return Walk{ vertexOf[0] };
  }
  auto neighbors = Adjacency(tree);
  for (std::size_t v = 0; v < neighbors.size(); ++v)
  {
    std::sort(neighbors[v].begin(), neighbors[v].end(), [&](int a, int b) {
      const Vector2 da = tree.points[a] - tree.points[v], db = tree.points[b] - tree.points[v];
      return std::atan2(da.y(), da.x()) < std::atan2(db.y(), db.x());
    });
  }
  // With the tree on the left, the walk turns at each vertex to the next edge counter-clockwise from where it came.
  Walk       walk;
  const auto start = tree.edges.front();
  int        from = start[0], here = start[1];
  do
  {
    walk.push_back(vertexOf[from]);
    const auto & around = neighbors[here];
    const auto   came = std::find(around.begin(), around.end(), from) - around.begin();
    const int    next = around[(came + 1) % around.size()];
    from = here;
    here = next;
  } while (from != start[0] || here != start[1]);
  return walk;
}
} // namespace tiling
} // namespace bone
