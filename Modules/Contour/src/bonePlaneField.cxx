/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlaneField.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace bone
{
namespace
{
constexpr double Far = 1e9;

// Marching squares on the grid with one more ring of nodes around it, all below the level.
class LevelTracer
{
public:
  LevelTracer(const PlaneField & field, double level)
    : m_Field(field)
    , m_Level(level)
    , m_Columns(field.grid.size[0] + 2)
    , m_Rows(field.grid.size[1] + 2)
    , m_Next(2 * static_cast<std::size_t>(m_Columns) * static_cast<std::size_t>(m_Rows), -1)
  {}

  std::vector<Polygon>
  Trace()
  {
    for (int j = 0; j + 1 < m_Rows; ++j)
    {
      for (int i = 0; i + 1 < m_Columns; ++i)
      {
        this->VisitCell(i, j);
      }
    }
    std::vector<Polygon> contours;
    for (std::size_t start = 0; start < m_Next.size(); ++start)
    {
      if (m_Next[start] < 0)
      {
        continue;
      }
      Polygon contour;
      for (int edge = static_cast<int>(start); m_Next[static_cast<std::size_t>(edge)] >= 0;)
      {
        contour.push_back(this->CrossingOn(edge));
        edge = std::exchange(m_Next[static_cast<std::size_t>(edge)], -1);
      }
      contours.push_back(std::move(contour));
    }
    return contours;
  }

private:
  double
  Value(int i, int j) const
  {
    const int    ci = std::clamp(i - 1, 0, m_Field.grid.size[0] - 1);
    const int    cj = std::clamp(j - 1, 0, m_Field.grid.size[1] - 1);
    const double value = m_Field.values[m_Field.grid.Offset(ci, cj)];
    const bool   outside = ci != i - 1 || cj != j - 1;
    return outside && value >= m_Level ? m_Level - std::max(value - m_Level, 1e-6) : value;
  }

  // Edges run from node (i, j): even ids to the right, odd ids up.
  int
  EdgeId(int i, int j, int up) const
  {
    return 2 * (j * m_Columns + i) + up;
  }

  void
  VisitCell(int i, int j)
  {
    const std::array<double, 4> v = { { Value(i, j), Value(i + 1, j), Value(i + 1, j + 1), Value(i, j + 1) } };
    int                         code = 0;
    for (int k = 0; k < 4; ++k)
    {
      code |= (v[k] >= m_Level) << k;
    }
    if (code == 0 || code == 15)
    {
      return;
    }
    // Side k runs from corner k to corner k + 1. The boundary keeps the inside on its left: it enters the cell through
    // a side from an inside to an outside corner.
    const std::array<int, 4> side = { { EdgeId(i, j, 0), EdgeId(i + 1, j, 1), EdgeId(i, j + 1, 0), EdgeId(i, j, 1) } };
    const auto               inside = [code](int k) { return (code >> (k & 3) & 1) != 0; };
    const bool               saddle = code == 5 || code == 10;
    const bool               joined = saddle && (v[0] + v[1] + v[2] + v[3]) / 4.0 >= m_Level;
    for (int k = 0; k < 4; ++k)
    {
      if (!inside(k) || inside(k + 1))
      {
        continue;
      }
      // It leaves at the other end of the inside corners on its left; where a saddle's inside corners are joined, it
      // goes around the outside corner on its right.
      int to = (k + (joined ? 1 : 3)) & 3;
      while (!joined && inside(to))
      {
        to = (to + 3) & 3;
      }
      m_Next[static_cast<std::size_t>(side[k])] = side[to];
    }
  }

  Vector2
  CrossingOn(int edge) const
  {
    const int    node = edge / 2;
    const int    i = node % m_Columns;
    const int    j = node / m_Columns;
    const bool   up = edge % 2 == 1;
    const double a = this->Value(i, j);
    const double b = up ? this->Value(i, j + 1) : this->Value(i + 1, j);
    // Kept off the nodes, so that no two crossings coincide.
    const double    t = std::clamp((m_Level - a) / (b - a), 1e-3, 1.0 - 1e-3);
    const PlaneGrid grid = m_Field.grid;
    Vector2         q = grid.Node(i - 1, j - 1);
    q[up ? 1 : 0] += t * grid.spacing[up ? 1 : 0];
    return q;
  }

  const PlaneField & m_Field;
  double             m_Level;
  int                m_Columns;
  int                m_Rows;
  std::vector<int>   m_Next;
};

struct Segment
{
  Vector2 a;
  Vector2 d;
  double  inverse; // 1 / |d|^2
  int     polygon;
  int     edge;
};

double
SquaredDistance(const Segment & s, const Vector2 & q, double & along)
{
  const Vector2 r = q - s.a;
  along = std::clamp(r.dot(s.d) * s.inverse, 0.0, 1.0);
  return (r - along * s.d).squaredNorm();
}

// Nearest segments by propagation over the grid.
class NearestSegments
{
public:
  NearestSegments(const std::vector<Segment> & segments, const PlaneGrid & grid, double limit)
    : m_Segments(segments)
    , m_Grid(grid)
    , m_SquaredLimit(limit * limit)
    , m_Nearest(grid.Count(), -1)
    , m_Squared(grid.Count(), std::numeric_limits<double>::max())
    , m_Along(grid.Count(), 0.0F)
  {
    for (std::size_t s = 0; s < segments.size(); ++s)
    {
      this->Seed(static_cast<int>(s));
    }
    this->Sweep(1);
    this->Sweep(-1);
  }

  const std::vector<Segment> & m_Segments;
  const PlaneGrid &            m_Grid;
  double                       m_SquaredLimit;
  std::vector<int>             m_Nearest;
  std::vector<double>          m_Squared;
  std::vector<float>           m_Along;

private:
  void
  Offer(int i, int j, int s)
  {
    double            along = 0.0;
    const std::size_t at = m_Grid.Offset(i, j);
    if (s < 0 || s == m_Nearest[at])
    {
      return;
    }
    const double squared = SquaredDistance(m_Segments[static_cast<std::size_t>(s)], m_Grid.Node(i, j), along);
    // Of segments that meet in the nearest point the first stays, whatever rounding says.
    if (squared < (1.0 - 1e-9) * m_Squared[at] - 1e-14)
    {
      m_Squared[at] = squared;
      m_Nearest[at] = s;
      m_Along[at] = static_cast<float>(along);
    }
  }

  void
  Seed(int s)
  {
    const Segment & segment = m_Segments[static_cast<std::size_t>(s)];
    const Vector2   b = segment.a + segment.d;
    // Points of level contours lie on the grid's lines: with a little slack they belong to the cells on both sides.
    const Vector2 slack = Vector2::Constant(1e-6);
    const Vector2 low = (segment.a.cwiseMin(b) - m_Grid.origin).cwiseQuotient(m_Grid.spacing) - slack;
    const Vector2 high = (segment.a.cwiseMax(b) - m_Grid.origin).cwiseQuotient(m_Grid.spacing) + slack;
    for (int j = std::max(0, static_cast<int>(std::floor(low.y())));
         j <= std::min(m_Grid.size[1] - 1, static_cast<int>(std::ceil(high.y())));
         ++j)
    {
      for (int i = std::max(0, static_cast<int>(std::floor(low.x())));
           i <= std::min(m_Grid.size[0] - 1, static_cast<int>(std::ceil(high.x())));
           ++i)
      {
        this->Offer(i, j, s);
      }
    }
  }

  void
  OfferFrom(int i, int j, int di, int dj)
  {
    const int ni = i + di;
    const int nj = j + dj;
    if (ni >= 0 && ni < m_Grid.size[0] && nj >= 0 && nj < m_Grid.size[1])
    {
      const std::size_t from = m_Grid.Offset(ni, nj);
      if (m_Squared[from] <= m_SquaredLimit)
      {
        this->Offer(i, j, m_Nearest[from]);
      }
    }
  }

  // Rows in the direction `step`, each from left to right and back.
  void
  Sweep(int step)
  {
    const int rows = m_Grid.size[1];
    const int columns = m_Grid.size[0];
    for (int row = 0; row < rows; ++row)
    {
      const int j = step > 0 ? row : rows - 1 - row;
      for (int i = 0; i < columns; ++i)
      {
        this->OfferFrom(i, j, -1, -step);
        this->OfferFrom(i, j, 0, -step);
        this->OfferFrom(i, j, 1, -step);
        this->OfferFrom(i, j, -1, 0);
      }
      for (int i = columns - 1; i >= 0; --i)
      {
        this->OfferFrom(i, j, 1, 0);
      }
    }
  }
};

// Marks the nodes inside the polygons (even-odd) row by row.
std::vector<char>
InsideNodes(const std::vector<Polygon> & polygons, const PlaneGrid & grid)
{
  std::vector<std::vector<double>> crossings(static_cast<std::size_t>(grid.size[1]));
  for (const Polygon & polygon : polygons)
  {
    for (std::size_t k = 0; k < polygon.size(); ++k)
    {
      Vector2 a = polygon[k];
      Vector2 b = polygon[(k + 1) % polygon.size()];
      if (a.y() > b.y())
      {
        std::swap(a, b);
      }
      const int first = std::max(0, static_cast<int>(std::floor((a.y() - grid.origin.y()) / grid.spacing.y())));
      for (int j = first; j < grid.size[1]; ++j)
      {
        const double y = grid.origin.y() + j * grid.spacing.y();
        if (y >= b.y())
        {
          break;
        }
        if (y >= a.y())
        {
          crossings[static_cast<std::size_t>(j)].push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
        }
      }
    }
  }
  std::vector<char> inside(grid.Count(), 0);
  for (int j = 0; j < grid.size[1]; ++j)
  {
    auto & row = crossings[static_cast<std::size_t>(j)];
    std::sort(row.begin(), row.end());
    for (std::size_t k = 0; k + 1 < row.size(); k += 2)
    {
      const double low = (row[k] - grid.origin.x()) / grid.spacing.x();
      const double high = (row[k + 1] - grid.origin.x()) / grid.spacing.x();
      for (int i = std::max(0, static_cast<int>(std::ceil(low))); i < grid.size[0] && i < high; ++i)
      {
        inside[grid.Offset(i, j)] = 1;
      }
    }
  }
  return inside;
}

// One pass of a symmetric kernel along an axis, borders replicated.
void
Convolve(PlaneField & field, int axis, const std::vector<float> & half)
{
  const int          n = field.grid.size[axis];
  const int          lines = field.grid.size[1 - axis];
  const std::size_t  stride = axis == 0 ? 1 : static_cast<std::size_t>(field.grid.size[0]);
  const std::size_t  lineStride = axis == 0 ? static_cast<std::size_t>(field.grid.size[0]) : 1;
  const int          radius = static_cast<int>(half.size()) - 1;
  std::vector<float> line(static_cast<std::size_t>(n + 2 * radius));
  for (int l = 0; l < lines; ++l)
  {
    float * values = field.values.data() + static_cast<std::size_t>(l) * lineStride;
    for (int i = -radius; i < n + radius; ++i)
    {
      line[static_cast<std::size_t>(i + radius)] = values[static_cast<std::size_t>(std::clamp(i, 0, n - 1)) * stride];
    }
    for (int i = 0; i < n; ++i)
    {
      const float * at = line.data() + i + radius;
      float         sum = half[0] * at[0];
      for (int r = 1; r <= radius; ++r)
      {
        sum += half[static_cast<std::size_t>(r)] * (at[-r] + at[r]);
      }
      values[static_cast<std::size_t>(i) * stride] = sum;
    }
  }
}
} // namespace

PlaneGrid
CoveringGrid(const std::vector<Polygon> & polygons, double margin, const Vector2 & anchor, const Vector2 & spacing)
{
  PlaneGrid grid;
  grid.spacing = spacing;
  grid.origin = anchor;
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::max());
  Vector2 high = -low;
  for (const Polygon & polygon : polygons)
  {
    for (const Vector2 & q : polygon)
    {
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
  }
  if (!(low.x() <= high.x()))
  {
    return grid;
  }
  for (int a = 0; a < 2; ++a)
  {
    // What falls on a node goes outward, whatever rounding says: polygons often begin at the anchor.
    const double first = std::floor((low[a] - margin - anchor[a]) / spacing[a] - 1e-6);
    const double last = std::ceil((high[a] + margin - anchor[a]) / spacing[a] + 1e-6);
    grid.origin[a] = anchor[a] + first * spacing[a];
    grid.size[static_cast<std::size_t>(a)] = static_cast<int>(last - first) + 1;
  }
  return grid;
}

double
PlaneField::Sample(const Vector2 & q) const
{
  const double x = std::clamp((q.x() - grid.origin.x()) / grid.spacing.x(), 0.0, grid.size[0] - 1.0);
  const double y = std::clamp((q.y() - grid.origin.y()) / grid.spacing.y(), 0.0, grid.size[1] - 1.0);
  const int    i = std::min(static_cast<int>(x), std::max(0, grid.size[0] - 2));
  const int    j = std::min(static_cast<int>(y), std::max(0, grid.size[1] - 2));
  const int    i1 = std::min(i + 1, grid.size[0] - 1);
  const int    j1 = std::min(j + 1, grid.size[1] - 1);
  const double s = x - i;
  const double t = y - j;
  return (1 - t) * ((1 - s) * values[grid.Offset(i, j)] + s * values[grid.Offset(i1, j)]) +
         t * ((1 - s) * values[grid.Offset(i, j1)] + s * values[grid.Offset(i1, j1)]);
}

double
PlaneField::SampleCubic(const Vector2 & q) const
{
  const double x = (q.x() - grid.origin.x()) / grid.spacing.x();
  const double y = (q.y() - grid.origin.y()) / grid.spacing.y();
  if (!(x >= 1.0) || !(y >= 1.0) || !(x < grid.size[0] - 2) || !(y < grid.size[1] - 2))
  {
    return this->Sample(q);
  }
  const auto weights = [](double t) {
    return std::array<double, 4>{ { -0.5 * t + t * t - 0.5 * t * t * t,
                                    1.0 - 2.5 * t * t + 1.5 * t * t * t,
                                    0.5 * t + 2.0 * t * t - 1.5 * t * t * t,
                                    -0.5 * t * t + 0.5 * t * t * t } };
  };
  const int  i = static_cast<int>(x);
  const int  j = static_cast<int>(y);
  const auto wx = weights(x - i);
  const auto wy = weights(y - j);
  double     value = 0.0;
  for (int b = 0; b < 4; ++b)
  {
    const float * row = values.data() + grid.Offset(i - 1, j - 1 + b);
    value += wy[static_cast<std::size_t>(b)] * (wx[0] * row[0] + wx[1] * row[1] + wx[2] * row[2] + wx[3] * row[3]);
  }
  return value;
}

std::vector<Polygon>
ExtractLevelContours(const PlaneField & field, double level)
{
  return field.values.empty() ? std::vector<Polygon>{} : LevelTracer(field, level).Trace();
}

void
SmoothField(PlaneField & field, double sigma)
{
  if (!(sigma > 0.0) || field.values.empty())
  {
    return;
  }
  for (int axis = 0; axis < 2; ++axis)
  {
    const double       s = sigma / field.grid.spacing[axis];
    const int          radius = static_cast<int>(std::ceil(3.0 * s));
    std::vector<float> half(static_cast<std::size_t>(radius) + 1);
    double             sum = 0.0;
    for (int r = 0; r <= radius; ++r)
    {
      half[static_cast<std::size_t>(r)] = static_cast<float>(std::exp(-0.5 * r * r / (s * s)));
      sum += (r == 0 ? 1.0 : 2.0) * half[static_cast<std::size_t>(r)];
    }
    for (float & w : half)
    {
      w = static_cast<float>(w / sum);
    }
    Convolve(field, axis, half);
  }
}

DistanceField
ComputeDistanceField(const std::vector<Polygon> & polygons, const PlaneGrid & grid, double limit)
{
  std::vector<Segment> segments;
  for (std::size_t p = 0; p < polygons.size(); ++p)
  {
    const Polygon & polygon = polygons[p];
    for (std::size_t k = 0; k < polygon.size(); ++k)
    {
      const Vector2 d = polygon[(k + 1) % polygon.size()] - polygon[k];
      const double  squared = d.squaredNorm();
      segments.push_back(
        { polygon[k], d, squared > 0.0 ? 1.0 / squared : 0.0, static_cast<int>(p), static_cast<int>(k) });
    }
  }
  const std::vector<char> inside = InsideNodes(polygons, grid);
  const NearestSegments   nearest(segments, grid, limit);
  DistanceField           field;
  field.distance.grid = grid;
  field.distance.values.resize(grid.Count());
  field.polygon.resize(grid.Count(), -1);
  field.edge.resize(grid.Count(), -1);
  field.along = nearest.m_Along;
  for (std::size_t n = 0; n < grid.Count(); ++n)
  {
    const int s = nearest.m_Nearest[n];
    if (s < 0)
    {
      field.distance.values[n] = static_cast<float>(inside[n] != 0 ? Far : -Far);
      continue;
    }
    const double distance = std::sqrt(nearest.m_Squared[n]);
    field.distance.values[n] = static_cast<float>(inside[n] != 0 ? distance : -distance);
    field.polygon[n] = segments[static_cast<std::size_t>(s)].polygon;
    field.edge[n] = segments[static_cast<std::size_t>(s)].edge;
  }
  return field;
}
} // namespace bone
