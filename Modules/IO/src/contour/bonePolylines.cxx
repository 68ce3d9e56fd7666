/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePolylines.h"

#include "boneRefuse.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <map>

namespace bone
{
namespace
{
// How far a point may lie off its plane, and two planes of one slice apart, mm: hand-placed points are rounded.
constexpr double PlaneTolerance = 0.05;

// Twice the area vector of a closed polygon.
Vector3
AreaVector(const std::vector<Vector3> & points)
{
  Vector3 area = Vector3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    area += (points[i] - points[0]).cross(points[(i + 1) % points.size()] - points[0]);
  }
  return area;
}

// A normal of the points' plane without regard to their order: a contour that crosses itself may enclose no area.
Vector3
SpannedNormal(const std::vector<Vector3> & points)
{
  const auto longest = [&](auto && length) {
    return *std::max_element(
      points.begin(), points.end(), [&](const Vector3 & a, const Vector3 & b) { return length(a) < length(b); });
  };
  const Vector3 along = longest([&](const Vector3 & p) { return (p - points[0]).norm(); }) - points[0];
  return along.cross(longest([&](const Vector3 & p) { return along.cross(p - points[0]).norm(); }) - points[0]);
}

int
LargestComponent(const Vector3 & v)
{
  int axis = 0;
  v.cwiseAbs().maxCoeff(&axis);
  return axis;
}

Vector3
CommonNormal(const std::vector<Polyline> & polylines)
{
  Vector3 sum = Vector3::Zero();
  for (const auto & polyline : polylines)
  {
    const auto & points = polyline.contour.points;
    Vector3      area = polyline.contour.axis ? Vector3(Vector3::Zero()) : AreaVector(points);
    if (const Vector3 spanned = SpannedNormal(points); area.norm() < 1e-6 * spanned.norm())
    {
      area = spanned;
    }
    sum += area.dot(sum) < 0 ? Vector3(-area) : area;
  }
  if (!(sum.norm() > 0) || !sum.allFinite())
  {
    Refuse("has no slice planes (SliceOrigin, SliceNormal), and its contours span no plane to find them by");
  }
  return sum[LargestComponent(sum)] < 0 ? Vector3(-sum.normalized()) : Vector3(sum.normalized());
}

double
MeanHeight(const std::vector<Vector3> & points, const Vector3 & normal)
{
  double sum = 0;
  for (const Vector3 & point : points)
  {
    sum += point.dot(normal);
  }
  return sum / static_cast<double>(points.size());
}

struct Group
{
  double                height{ 0 };
  std::vector<Polyline> polylines;
};

// Polylines of one slice: those with one number, or, without numbers, those at one height.
std::vector<Group>
GroupBySlice(std::vector<Polyline> polylines, const Vector3 & normal)
{
  std::map<int, Group> numbered;
  std::vector<Group>   groups;
  const auto heightOf = [&](const Polyline & polyline) { return MeanHeight(polyline.contour.points, normal); };
  std::stable_sort(polylines.begin(), polylines.end(), [&](const Polyline & a, const Polyline & b) {
    return heightOf(a) < heightOf(b);
  });
  for (auto & polyline : polylines)
  {
    const double height = heightOf(polyline);
    if (polyline.slice >= 0)
    {
      auto & group = numbered[polyline.slice];
      group.height = group.polylines.empty() ? height : group.height;
      group.polylines.push_back(std::move(polyline));
      continue;
    }
    if (groups.empty() || height - groups.back().height > PlaneTolerance)
    {
      groups.push_back({ height, {} });
    }
    groups.back().polylines.push_back(std::move(polyline));
  }
  for (auto & entry : numbered)
  {
    groups.push_back(std::move(entry.second));
  }
  std::stable_sort(groups.begin(), groups.end(), [](const Group & a, const Group & b) { return a.height < b.height; });
  return groups;
}

// Brings the points, which are rounded, into the plane.
void
Flatten(std::vector<Vector3> & points, const Vector3 & normal, double height)
{
  for (Vector3 & point : points)
  {
    const double off = point.dot(normal) - height;
    if (!(std::abs(off) <= PlaneTolerance))
    {
      Refuse("a contour does not lie in a plane parallel to the others: a point is ", std::abs(off), " mm off it");
    }
    point -= off * normal;
  }
}

std::vector<Vector2>
InPlane(const ContourStack * stack, const Contour & contour)
{
  std::vector<Vector2> polygon;
  for (const Vector3 & point : contour.points)
  {
    polygon.push_back(stack->ToPlane(point));
  }
  return polygon;
}

void
OrientWithoutRegions(const ContourStack * stack, std::vector<Polyline> & polylines)
{
  std::vector<std::vector<Vector2>> polygons;
  for (const auto & polyline : polylines)
  {
    polygons.push_back(InPlane(stack, polyline.contour));
  }
  for (std::size_t c = 0; c < polylines.size(); ++c)
  {
    Contour & contour = polylines[c].contour;
    if (polylines[c].hasRegion || contour.axis)
    {
      continue;
    }
    int depth = 0;
    for (std::size_t other = 0; other < polylines.size(); ++other)
    {
      const Contour & around = polylines[other].contour;
      depth +=
        other != c && !around.axis && around.layer == 0 && PointInPolygon(polygons[c][0], polygons[other]) ? 1 : 0;
    }
    const bool hole = contour.layer == 0 && depth % 2 == 1;
    contour.region = hole ? static_cast<int>(Region::Outside) : contour.layer + 1;
    if ((SignedArea(polygons[c]) < 0) != hole)
    {
      std::reverse(contour.points.begin() + 1, contour.points.end());
    }
  }
}

void
NumberWithoutIds(std::vector<Polyline> & polylines)
{
  int next = 0;
  for (const auto & polyline : polylines)
  {
    next = polyline.hasId ? std::max(next, polyline.contour.id + 1) : next;
  }
  for (auto & polyline : polylines)
  {
    polyline.contour.id = polyline.hasId ? polyline.contour.id : next++;
  }
}
} // namespace

void
SetFrameFromNormal(ContourStack * stack, const Vector3 & normal)
{
  const Vector3 n = normal.normalized();
  Vector3       axis = Vector3::Zero();
  axis[(LargestComponent(n) + 1) % 3] = 1.0;
  const Vector3 u = (axis - axis.dot(n) * n).normalized();
  stack->SetFrame(u, n.cross(u));
}

ContourStack::Pointer
StackPolylines(std::vector<Polyline> polylines, Vector3 normal, Vector3 u)
{
  if (polylines.empty())
  {
    Refuse("holds no contours");
  }
  if (normal.isZero(0))
  {
    normal = CommonNormal(polylines);
  }
  auto stack = ContourStack::New();
  if (u.isZero(0))
  {
    SetFrameFromNormal(stack, normal);
  }
  else
  {
    stack->SetFrame(u, normal.cross(u));
  }
  ContourStack::SliceContainer slices;
  for (auto & group : GroupBySlice(std::move(polylines), stack->GetNormal()))
  {
    for (auto & polyline : group.polylines)
    {
      Flatten(polyline.contour.points, stack->GetNormal(), group.height);
    }
    OrientWithoutRegions(stack, group.polylines);
    NumberWithoutIds(group.polylines);
    ContourSlice slice;
    slice.origin = group.polylines.front().contour.points.front();
    for (auto & polyline : group.polylines)
    {
      slice.contours.push_back(std::move(polyline.contour));
    }
    slices.push_back(std::move(slice));
  }
  stack->SetSlices(std::move(slices));
  return stack;
}
} // namespace bone
