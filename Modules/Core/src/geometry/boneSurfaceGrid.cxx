/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceGrid.h"

#include "bonePredicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
TriangleIds
Ascending(TriangleIds ids)
{
  std::sort(ids.begin(), ids.end());
  return ids;
}

namespace
{
bool
Has(const TriangleIds & t, IdType p)
{
  return t[0] == p || t[1] == p || t[2] == p;
}

/** Coordinates in the plane of the triangle's largest projection. */
struct Projection
{
  int u;
  int v;

  Projection(const Vector3 & a, const Vector3 & b, const Vector3 & c)
  {
    int axis = 0;
    (b - a).cross(c - a).cwiseAbs().maxCoeff(&axis);
    u = (axis + 1) % 3;
    v = (axis + 2) % 3;
  }
  Vector2
  operator()(const Vector3 & x) const
  {
    return { x[u], x[v] };
  }
};

bool
SegmentsMeet2D(const Vector2 & p, const Vector2 & q, const Vector2 & r, const Vector2 & s)
{
  const int a = Orient2D(p, q, r), b = Orient2D(p, q, s), c = Orient2D(r, s, p), d = Orient2D(r, s, q);
  if (a == 0 && b == 0)
  {
    const bool u = std::max(p.x(), q.x()) >= std::min(r.x(), s.x()) && std::max(r.x(), s.x()) >= std::min(p.x(), q.x());
    const bool v = std::max(p.y(), q.y()) >= std::min(r.y(), s.y()) && std::max(r.y(), s.y()) >= std::min(p.y(), q.y());
    return u && v;
  }
  return a * b <= 0 && c * d <= 0;
}

/** Orient3D in arithmetic of type T; false where that leaves it open. */
template <typename T>
bool
SideOf(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d, int & side)
{
  constexpr T           epsilon = std::numeric_limits<T>::epsilon() / 2;
  T                     m[3][3];
  const Vector3 * const points[3] = { &b, &c, &d };
  for (int i = 0; i < 3; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      m[i][k] = T((*points[i])[k]) - T(a[k]);
    }
  }
  T det = 0, permanent = 0;
  for (int k = 0; k < 3; ++k)
  {
    const T p = m[1][(k + 1) % 3] * m[2][(k + 2) % 3], q = m[1][(k + 2) % 3] * m[2][(k + 1) % 3];
    det += m[0][k] * (p - q);
    permanent += std::abs(m[0][k]) * (std::abs(p) + std::abs(q));
  }
  // Shewchuk's static bound, with some slack.
  const T bound = 10 * epsilon * permanent + T(1e-280);
  side = det > 0 ? 1 : -1;
  return std::abs(det) > bound;
}

/** Orient3D with two steps before its rational arithmetic: neighbouring triangles are often coplanar but for rounding,
 * or exactly so in a plane of the coordinate system. */
int
Side(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d)
{
  for (int k = 0; k < 3; ++k)
  {
    if (a[k] == b[k] && a[k] == c[k] && a[k] == d[k])
    {
      return 0;
    }
  }
  int side = 0;
  return SideOf<double>(a, b, c, d, side) || SideOf<long double>(a, b, c, d, side) ? side : Orient3D(a, b, c, d);
}

bool
SegmentMeetsTriangle(const Vector3 & p, const Vector3 & q, const Vector3 & a, const Vector3 & b, const Vector3 & c)
{
  const int op = Side(a, b, c, p), oq = Side(a, b, c, q);
  if (op * oq > 0)
  {
    return false;
  }
  if (op == 0 && oq == 0)
  {
    const Projection project(a, b, c);
    const Vector2    p2 = project(p), q2 = project(q), a2 = project(a), b2 = project(b), c2 = project(c);
    const int        o1 = Orient2D(a2, b2, p2), o2 = Orient2D(b2, c2, p2), o3 = Orient2D(c2, a2, p2);
    const bool       inside = (o1 >= 0 && o2 >= 0 && o3 >= 0) || (o1 <= 0 && o2 <= 0 && o3 <= 0);
    return inside || SegmentsMeet2D(p2, q2, a2, b2) || SegmentsMeet2D(p2, q2, b2, c2) || SegmentsMeet2D(p2, q2, c2, a2);
  }
  const int o1 = Side(p, q, a, b), o2 = Side(p, q, b, c), o3 = Side(p, q, c, a);
  return (o1 >= 0 && o2 >= 0 && o3 >= 0) || (o1 <= 0 && o2 <= 0 && o3 <= 0);
}

struct Box
{
  Vector3 lower;
  Vector3 upper;

  Box(const Vector3 & a, const Vector3 & b, const Vector3 & c)
    : lower(a.cwiseMin(b).cwiseMin(c))
    , upper(a.cwiseMax(b).cwiseMax(c))
  {}
  Box(const TriangleIds & t, const std::vector<Vector3> & points)
    : Box(points[t[0]], points[t[1]], points[t[2]])
  {}

  bool
  Meets(const TriangleIds & t, const std::vector<Vector3> & points) const
  {
    const Vector3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    for (int k = 0; k < 3; ++k)
    {
      if (std::min({ a[k], b[k], c[k] }) > upper[k] || std::max({ a[k], b[k], c[k] }) < lower[k])
      {
        return false;
      }
    }
    return true;
  }
};

/** Two triangles on one edge cross where they lie in one plane on the same side of it. */
bool
FoldsOnto(IdType p, IdType q, IdType apexS, IdType apexT, const std::vector<Vector3> & points)
{
  const Vector3 &a = points[p], &b = points[q], &c = points[apexS], &d = points[apexT];
  if (Side(a, b, c, d) != 0)
  {
    return false;
  }
  const Projection project(a, b, c);
  return Orient2D(project(a), project(b), project(c)) * Orient2D(project(a), project(b), project(d)) > 0;
}

using Cell = SurfaceGrid::Cell;
using Range = SurfaceGrid::Range;

Range
RangeOf(const Box & box, double scale)
{
  const auto cell = [scale](const Vector3 & x) {
    const auto at = [&](int k) { return static_cast<std::int64_t>(std::floor(x[k] * scale)); };
    return Cell{ at(0), at(1), at(2) };
  };
  return { cell(box.lower), cell(box.upper) };
}

/** Calls visit(cell, key) for each cell, until it says true. */
template <typename TVisit>
void
ForEachCell(const Range & range, TVisit visit)
{
  constexpr std::uint64_t mask = (1u << 21) - 1;
  Cell                    c{};
  for (c[0] = range.lower[0]; c[0] <= range.upper[0]; ++c[0])
  {
    for (c[1] = range.lower[1]; c[1] <= range.upper[1]; ++c[1])
    {
      for (c[2] = range.lower[2]; c[2] <= range.upper[2]; ++c[2])
      {
        const std::uint64_t key = ((static_cast<std::uint64_t>(c[0]) & mask) << 42) |
                                  ((static_cast<std::uint64_t>(c[1]) & mask) << 21) |
                                  (static_cast<std::uint64_t>(c[2]) & mask);
        if (visit(c, key))
        {
          return;
        }
      }
    }
  }
}

/** Whether a cell is the first of those that two triangles have in common, by which each pair is met once. */
bool
IsFirstOfBoth(const Cell & cell, const Cell & lower, const Cell & otherLower)
{
  return cell[0] == std::max(lower[0], otherLower[0]) && cell[1] == std::max(lower[1], otherLower[1]) &&
         cell[2] == std::max(lower[2], otherLower[2]);
}
} // namespace

bool
TrianglesCross(const TriangleIds & s, const TriangleIds & t, const std::vector<Vector3> & points)
{
  IdType onlyS[3], onlyT[3], shared[3];
  int    nS = 0, nT = 0, n = 0;
  for (IdType p : s)
  {
    (Has(t, p) ? shared[n++] : onlyS[nS++]) = p;
  }
  for (IdType p : t)
  {
    if (!Has(s, p))
    {
      onlyT[nT++] = p;
    }
  }
  const auto meets = [&points](IdType p, IdType q, const TriangleIds & u) {
    return SegmentMeetsTriangle(points[p], points[q], points[u[0]], points[u[1]], points[u[2]]);
  };
  switch (n)
  {
    case 3:
      return true;
    case 2:
      return FoldsOnto(shared[0], shared[1], onlyS[0], onlyT[0], points);
    case 1:
      return meets(onlyS[0], onlyS[1], t) || meets(onlyT[0], onlyT[1], s);
    default:
      break;
  }
  const auto apart = [&points](const TriangleIds & u, const TriangleIds & v) {
    const auto side = [&](int k) { return Side(points[u[0]], points[u[1]], points[u[2]], points[v[k]]); };
    const int  first = side(0);
    return first != 0 && side(1) == first && side(2) == first;
  };
  if (apart(s, t) || apart(t, s))
  {
    return false;
  }
  for (int k = 0; k < 3; ++k)
  {
    if (meets(s[k], s[(k + 1) % 3], t) || meets(t[k], t[(k + 1) % 3], s))
    {
      return true;
    }
  }
  return false;
}

SurfaceGrid::SurfaceGrid(double cellSize)
  : m_Scale(1.0 / cellSize)
{}

void
SurfaceGrid::Insert(const TriangleIds & triangle, const std::vector<Vector3> & points)
{
  this->Insert(triangle, RangeOf(Box(triangle, points), m_Scale));
}

void
SurfaceGrid::Erase(const TriangleIds & triangle, const std::vector<Vector3> & points)
{
  this->Erase(triangle, RangeOf(Box(triangle, points), m_Scale));
}

void
SurfaceGrid::Move(const TriangleIds & triangle, IdType p, const Vector3 & before, const std::vector<Vector3> & points)
{
  const auto  at = [&](int k) -> const Vector3 & { return triangle[k] == p ? before : points[triangle[k]]; };
  const Range from = RangeOf(Box(at(0), at(1), at(2)), m_Scale), to = RangeOf(Box(triangle, points), m_Scale);
  if (from.lower != to.lower || from.upper != to.upper)
  {
    this->Erase(triangle, from);
    this->Insert(triangle, to);
  }
}

void
SurfaceGrid::Insert(const TriangleIds & triangle, const Range & range)
{
  const Entry entry{ Ascending(triangle), range.lower };
  ForEachCell(range, [&](const Cell &, std::uint64_t key) {
    m_Cells[key].push_back(entry);
    return false;
  });
}

void
SurfaceGrid::Erase(const TriangleIds & triangle, const Range & range)
{
  const TriangleIds ids = Ascending(triangle);
  ForEachCell(range, [&](const Cell &, std::uint64_t key) {
    const auto cell = m_Cells.find(key);
    if (cell != m_Cells.end())
    {
      auto &     content = cell->second;
      const auto at = std::find_if(content.begin(), content.end(), [&ids](const Entry & e) { return e.ids == ids; });
      if (at != content.end())
      {
        *at = content.back();
        content.pop_back();
      }
    }
    return false;
  });
}

bool
SurfaceGrid::Crosses(const TriangleIds & triangle, IdType ignored, const std::vector<Vector3> & points) const
{
  bool        crosses = false;
  const Box   box(triangle, points);
  const Range range = RangeOf(box, m_Scale);
  ForEachCell(range, [&](const Cell & c, std::uint64_t key) {
    const auto cell = m_Cells.find(key);
    crosses = cell != m_Cells.end() && std::any_of(cell->second.begin(), cell->second.end(), [&](const Entry & entry) {
                return IsFirstOfBoth(c, range.lower, entry.lower) && !Has(entry.ids, ignored) &&
                       box.Meets(entry.ids, points) && TrianglesCross(triangle, entry.ids, points);
              });
    return crosses;
  });
  return crosses;
}

std::vector<std::array<int, 2>>
FindCrossingTriangles(const std::vector<TriangleIds> & triangles, const std::vector<Vector3> & points)
{
  double length = 0.0;
  for (const TriangleIds & t : triangles)
  {
    length += (points[t[1]] - points[t[0]]).norm() / static_cast<double>(triangles.size());
  }
  struct Placed
  {
    int  triangle;
    Cell lower;
  };
  const double                                           scale = length > 0 ? 1.0 / length : 1.0;
  std::unordered_map<std::uint64_t, std::vector<Placed>> cells;
  std::vector<std::array<int, 2>>                        pairs;
  for (int i = 0; i < static_cast<int>(triangles.size()); ++i)
  {
    const Box   box(triangles[i], points);
    const Range range = RangeOf(box, scale);
    ForEachCell(range, [&](const Cell & c, std::uint64_t key) {
      auto & cell = cells[key];
      for (const auto & [j, lower] : cell)
      {
        if (IsFirstOfBoth(c, range.lower, lower) && box.Meets(triangles[j], points) &&
            TrianglesCross(triangles[i], triangles[j], points))
        {
          pairs.push_back({ j, i });
        }
      }
      cell.push_back({ i, range.lower });
      return false;
    });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}
} // namespace bone
