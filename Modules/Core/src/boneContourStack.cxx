/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourStack.h"

#include "bonePredicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>

namespace bone
{
namespace
{
// Points may lie off their plane by what single precision leaves of a coordinate of a metre.
constexpr double PlaneTolerance = 1e-3;

struct Edge
{
  Vector2     a;
  Vector2     b;
  std::size_t contour;
  std::size_t index;  // of the edge in its contour
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
  if (e.contour == f.contour && e.next == f.index)
  {
    return FoldsBack(e, f) || (f.next == e.index && FoldsBack(f, e));
  }
  if (e.contour == f.contour && f.next == e.index)
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

std::string
Name(const ContourSlice & slice, std::size_t k, std::size_t c)
{
  std::ostringstream text;
  text << (slice.contours[c].axis ? "medial axis " : "contour ") << slice.contours[c].id << " (layer "
       << slice.contours[c].layer << ") of slice " << k;
  return text.str();
}

void
AppendEdges(const Contour & contour, std::size_t c, const ContourStack & stack, std::vector<Edge> & edges)
{
  const std::size_t n = contour.points.size();
  const std::size_t count = contour.axis ? n - 1 : n;
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::size_t next = contour.axis && i + 1 == count ? i : (i + 1) % count;
    edges.push_back(
      { stack.ToPlane(contour.points[i]), stack.ToPlane(contour.points[(i + 1) % n]), c, i, next, !contour.axis });
  }
}

// What is wrong with a contour's points taken one by one; empty: nothing.
std::string
DescribeBadPoints(const Contour & contour, const ContourStack & stack, double height)
{
  const std::size_t n = contour.points.size();
  if (n < (contour.axis ? 1 : 3))
  {
    return contour.axis ? "has no point" : "has fewer than three points";
  }
  for (std::size_t i = 0; i < n; ++i)
  {
    std::ostringstream text;
    if (!contour.points[i].allFinite())
    {
      text << "has a point that is not finite (point " << i << ")";
      return text.str();
    }
    const double off = contour.points[i].dot(stack.GetNormal()) - height;
    if (!(std::abs(off) <= PlaneTolerance))
    {
      text << "has a point " << off << " mm off the slice's plane (point " << i << ")";
      return text.str();
    }
    if ((!contour.axis || i + 1 < n) && stack.ToPlane(contour.points[i]) == stack.ToPlane(contour.points[(i + 1) % n]))
    {
      text << "repeats a point (point " << i << ")";
      return text.str();
    }
  }
  return {};
}
} // namespace

void
ContourStack::SetSlices(SliceContainer slices)
{
  m_Slices = std::move(slices);
  this->Modified();
}

void
ContourStack::SetFrame(const Vector3 & u, const Vector3 & v)
{
  const Vector3 unitU = u.normalized();
  const Vector3 across = v - v.dot(unitU) * unitU;
  if (!u.allFinite() || !v.allFinite() || !(u.norm() > 0.0) || !(across.norm() > 1e-9 * v.norm()))
  {
    itkExceptionMacro("The in-plane axes (" << u.transpose() << ") and (" << v.transpose()
                                            << ") must be finite and not parallel.");
  }
  m_U = unitU;
  m_V = across.normalized();
  m_Normal = m_U.cross(m_V);
  this->Modified();
}

std::size_t
ContourStack::GetNumberOfContours() const
{
  std::size_t count = 0;
  for (const ContourSlice & slice : m_Slices)
  {
    count += slice.contours.size();
  }
  return count;
}

void
ContourStack::Verify() const
{
  for (std::size_t k = 0; k < m_Slices.size(); ++k)
  {
    const ContourSlice & slice = m_Slices[k];
    if (!slice.origin.allFinite())
    {
      itkExceptionMacro("The origin of slice " << k << " is not finite.");
    }
    if (k > 0 && !(this->GetHeight(k) > this->GetHeight(k - 1)))
    {
      itkExceptionMacro("Slice " << k << " at " << this->GetHeight(k) << " mm is not above slice " << k - 1 << " at "
                                 << this->GetHeight(k - 1) << " mm: sort the slices along the normal.");
    }
    std::vector<Edge> edges;
    for (std::size_t c = 0; c < slice.contours.size(); ++c)
    {
      const std::string wrong = DescribeBadPoints(slice.contours[c], *this, this->GetHeight(k));
      if (!wrong.empty())
      {
        itkExceptionMacro("The " << Name(slice, k, c) << ' ' << wrong << '.');
      }
      AppendEdges(slice.contours[c], c, *this, edges);
    }
    std::size_t first = 0;
    std::size_t second = 0;
    if (edges.empty() || !EdgeGrid(edges).FindConflict(first, second))
    {
      continue;
    }
    const std::size_t a = edges[first].contour;
    const std::size_t b = edges[second].contour;
    itkExceptionMacro("The " << Name(slice, k, a) << " crosses or touches "
                             << (a == b ? std::string("itself") : "the " + Name(slice, k, b)) << " near ("
                             << slice.contours[a].points[edges[first].index].transpose() << ").");
  }
}

void
ContourStack::Initialize()
{
  Superclass::Initialize();
  m_Slices.clear();
  m_U = Vector3::UnitX();
  m_V = Vector3::UnitY();
  m_Normal = Vector3::UnitZ();
  m_OpenStart = false;
  m_OpenEnd = false;
}

void
ContourStack::Graft(const itk::DataObject * data)
{
  const auto * other = dynamic_cast<const Self *>(data);
  if (data != nullptr && other == nullptr)
  {
    itkExceptionMacro("Cannot graft a " << data->GetNameOfClass() << " onto a ContourStack.");
  }
  Superclass::Graft(data);
  if (other != nullptr)
  {
    m_Slices = other->m_Slices;
    m_U = other->m_U;
    m_V = other->m_V;
    m_Normal = other->m_Normal;
    m_OpenStart = other->m_OpenStart;
    m_OpenEnd = other->m_OpenEnd;
  }
}

void
ContourStack::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Slices: " << m_Slices.size() << '\n';
  os << indent << "Contours: " << this->GetNumberOfContours() << '\n';
  os << indent << "U: " << m_U.transpose() << '\n';
  os << indent << "V: " << m_V.transpose() << '\n';
  os << indent << "Normal: " << m_Normal.transpose() << '\n';
  os << indent << "OpenStart: " << m_OpenStart << '\n';
  os << indent << "OpenEnd: " << m_OpenEnd << '\n';
}

double
SignedArea(const std::vector<Vector2> & polygon)
{
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    // Relative to the first point: no cancellation far from the origin.
    const Vector2 a = polygon[i] - polygon[0];
    const Vector2 b = polygon[(i + 1) % polygon.size()] - polygon[0];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * area;
}

bool
PointInPolygon(const Vector2 & q, const std::vector<Vector2> & polygon)
{
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
  {
    const Vector2 & a = polygon[j];
    const Vector2 & b = polygon[i];
    if ((a.y() > q.y()) != (b.y() > q.y()) && q.x() < a.x() + (q.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
    {
      inside = !inside;
    }
  }
  return inside;
}
} // namespace bone
