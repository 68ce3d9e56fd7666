/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourShape.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
struct Polygon
{
  std::vector<Vector2> points;
  double               area;
  int                  inside;  ///< region
  int                  outside; ///< region
};

std::vector<Polygon>
PolygonsOf(const ContourStack & stack, const ContourSlice & slice)
{
  std::vector<Polygon> polygons;
  for (const Contour & contour : slice.contours)
  {
    if (!contour.axis && contour.points.size() > 2)
    {
      std::vector<Vector2> points;
      for (const Vector3 & x : contour.points)
      {
        points.push_back(stack.ToPlane(x));
      }
      const double area = std::abs(SignedArea(points));
      polygons.push_back({ std::move(points), area, contour.region, Region::Outside });
    }
  }
  // What is around a contour is the material of the smallest one that has it inside.
  for (Polygon & polygon : polygons)
  {
    const Polygon * parent = nullptr;
    for (const Polygon & other : polygons)
    {
      if (&other != &polygon && other.area > polygon.area && (!parent || other.area < parent->area) &&
          PointInPolygon(polygon.points.front(), other.points))
      {
        parent = &other;
      }
    }
    polygon.outside = parent ? parent->inside : Region::Outside;
  }
  return polygons;
}
double
LengthOf(const std::vector<Vector2> & polygon)
{
  double length = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    length += (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
  }
  return length;
}

/** Calls visit(point, unit normal to the right) at points evenly along a polygon. */
template <typename TVisit>
void
WalkPolygon(const std::vector<Vector2> & polygon, double step, TVisit visit)
{
  double next = 0.5 * step, along = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vector2 edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    const double  length = edge.norm();
    for (; length > 0 && next <= along + length; next += step)
    {
      visit(polygon[i] + edge * ((next - along) / length), Vector2(edge.y(), -edge.x()) / length);
    }
    along += length;
  }
}
} // namespace

ContourShape::ContourShape(const ContourStack & stack)
{
  auto frame = ContourStack::New();
  frame->SetFrame(stack.GetU(), stack.GetV());
  m_Frame = frame;
  for (std::size_t k = 0; k < stack.GetSlices().size(); ++k)
  {
    m_Heights.push_back(stack.GetHeight(k));
    m_Sections.emplace_back();
    const std::vector<Polygon> polygons = PolygonsOf(stack, stack.GetSlices()[k]);
    int                        levels = 0;
    for (const Polygon & polygon : polygons)
    {
      levels = std::max(levels, polygon.inside);
    }
    for (int level = 1; level <= levels; ++level)
    {
      Section                             section;
      std::vector<TriangleTree::Triangle> segments;
      for (const Polygon & polygon : polygons)
      {
        if ((polygon.inside >= level) == (polygon.outside >= level))
        {
          continue;
        }
        const auto & q = polygon.points;
        for (std::size_t i = 0; i < q.size(); ++i)
        {
          const Vector2 & next = q[(i + 1) % q.size()];
          const Vector3   a(q[i].x(), q[i].y(), 0.0), b(next.x(), next.y(), 0.0);
          segments.push_back({ a, b, b });
        }
        section.polygons.push_back(q);
        section.sides.push_back((polygon.inside >= level) == (SignedArea(q) > 0) ? 1.0 : -1.0);
      }
      section.tree = TriangleTree(std::move(segments));
      m_Sections.back().push_back(std::move(section));
    }
  }
}

std::pair<double, Vector2>
ContourShape::Section::Evaluate(const Vector2 & q) const
{
  const auto    nearest = tree.FindNearest({ q.x(), q.y(), 0.0 });
  const double  distance = std::sqrt(nearest.squaredDistance);
  const Vector2 away(q.x() - nearest.point.x(), q.y() - nearest.point.y());
  bool          inside = false;
  for (const auto & polygon : polygons)
  {
    inside = inside != PointInPolygon(q, polygon);
  }
  const double sign = inside ? -1.0 : 1.0;
  if (distance > 0)
  {
    return { sign * distance, away * (sign / distance) };
  }
  // On the contour: bone lies on the left.
  const auto &  segment = tree.GetTriangle(nearest.triangle);
  const Vector2 along(segment[1].x() - segment[0].x(), segment[1].y() - segment[0].y());
  return { 0.0, Vector2(along.y(), -along.x()).normalized() };
}

template <typename TVisit>
void
ContourShape::ForEachSection(int level, TVisit visit) const
{
  for (std::size_t k = 0; k < m_Sections.size(); ++k)
  {
    if (level > 0 && m_Sections[k].size() >= static_cast<std::size_t>(level))
    {
      visit(k, m_Sections[k][level - 1]);
    }
  }
}

int
ContourShape::GetLevels() const
{
  std::size_t levels = 0;
  for (const auto & sections : m_Sections)
  {
    levels = std::max(levels, sections.size());
  }
  return static_cast<int>(levels);
}

double
ContourShape::GetContourLength(int level) const
{
  double length = 0.0;
  this->ForEachSection(level, [&](std::size_t, const Section & section) {
    for (const auto & polygon : section.polygons)
    {
      length += LengthOf(polygon);
    }
  });
  return length;
}

std::vector<ContourShape::Sample>
ContourShape::SampleContours(int level, double spacing) const
{
  constexpr double    fewest = 3.0;
  std::vector<Sample> samples;
  this->ForEachSection(level, [&](std::size_t k, const Section & section) {
    const std::size_t next = std::min(k + 1, m_Heights.size() - 1), last = k > 0 ? k - 1 : 0;
    const double      thickness = 0.5 * (m_Heights[next] - m_Heights[last]);
    for (std::size_t i = 0; i < section.polygons.size(); ++i)
    {
      const double length = LengthOf(section.polygons[i]);
      const double step = length / std::max(fewest, std::ceil(length / spacing));
      WalkPolygon(section.polygons[i], step, [&](const Vector2 & x, const Vector2 & right) {
        samples.push_back(
          { m_Frame->FromPlane(x, m_Heights[k]), m_Frame->FromPlane(section.sides[i] * right, 0.0), step * thickness });
      });
    }
  });
  return samples;
}

std::optional<ContourShape::Value>
ContourShape::Evaluate(int level, const Vector3 & x) const
{
  const double height = x.dot(m_Frame->GetNormal());
  const auto   upper = std::upper_bound(m_Heights.begin(), m_Heights.end(), height);
  if (level < 1 || upper == m_Heights.begin() || (upper == m_Heights.end() && height > m_Heights.back()))
  {
    return std::nullopt;
  }
  const Vector2     q = m_Frame->ToPlane(x);
  const std::size_t k = std::min<std::size_t>(upper - m_Heights.begin(), m_Heights.size() - 1);
  const std::size_t slices[2] = { k > 0 ? k - 1 : 0, k };
  const double      step = m_Heights[slices[1]] - m_Heights[slices[0]];
  const double      share = step > 0 ? (height - m_Heights[slices[0]]) / step : 1.0;
  double            values[2];
  Vector2           gradient = Vector2::Zero();
  for (int i = 0; i < 2; ++i)
  {
    const auto & sections = m_Sections[slices[i]];
    if (sections.size() < static_cast<std::size_t>(level) || sections[level - 1].tree.IsEmpty())
    {
      return std::nullopt;
    }
    const auto [distance, direction] = sections[level - 1].Evaluate(q);
    values[i] = distance;
    gradient += (i == 0 ? 1.0 - share : share) * direction;
  }
  const double rise = step > 0 ? (values[1] - values[0]) / step : 0.0;
  return Value{ (1.0 - share) * values[0] + share * values[1], m_Frame->FromPlane(gradient, rise) };
}
} // namespace bone
