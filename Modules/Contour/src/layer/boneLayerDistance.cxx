/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLayerDistance.h"

#include "boneContourStack.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
constexpr std::size_t EdgesPerBox = 16;
}

NearestOnPolygon::NearestOnPolygon(const Polygon & polygon)
  : m_Polygon(&polygon)
{
  for (std::size_t i = 0; i < polygon.size(); i += EdgesPerBox)
  {
    Eigen::AlignedBox2d box(polygon[i]);
    for (std::size_t k = i; k <= std::min(i + EdgesPerBox, polygon.size()); ++k)
    {
      box.extend(polygon[k % polygon.size()]);
    }
    m_Boxes.push_back(box);
  }
}

NearestOnPolygon::Found
NearestOnPolygon::operator()(const Vector2 & q) const
{
  const Polygon & polygon = *m_Polygon;
  Found           best;
  double          squaredBest = std::numeric_limits<double>::max();
  for (std::size_t b = 0; b < m_Boxes.size(); ++b)
  {
    if (m_Boxes[b].squaredExteriorDistance(q) >= squaredBest)
    {
      continue;
    }
    for (std::size_t i = b * EdgesPerBox; i < std::min((b + 1) * EdgesPerBox, polygon.size()); ++i)
    {
      const Vector2 & a = polygon[i];
      const Vector2   d = polygon[(i + 1) % polygon.size()] - a;
      const double    squared = d.squaredNorm();
      const double    t = squared > 0.0 ? std::clamp((q - a).dot(d) / squared, 0.0, 1.0) : 0.0;
      const Vector2   foot = a + t * d;
      if ((q - foot).squaredNorm() < squaredBest)
      {
        squaredBest = (q - foot).squaredNorm();
        best = { 0.0, foot, i, t };
      }
    }
  }
  best.distance = std::sqrt(squaredBest);
  return best;
}

double
DistanceBetween(const Polygon & a, const Polygon & b)
{
  const NearestOnPolygon toA(a);
  const NearestOnPolygon toB(b);
  double                 distance = std::numeric_limits<double>::max();
  for (const Vector2 & q : a)
  {
    distance = std::min(distance, toB(q).distance);
  }
  for (const Vector2 & q : b)
  {
    distance = std::min(distance, toA(q).distance);
  }
  return distance;
}

int
MoveAway(Polygon & inner, const Polygon & fixed, bool inside, double gap)
{
  constexpr int          mostPasses = 40;
  const double           wanted = gap + 1e-7;
  const NearestOnPolygon toFixed(fixed);
  const Polygon          before = inner;
  int                    moved = 0;
  for (int pass = 0; pass < mostPasses; ++pass)
  {
    bool good = true;
    for (Vector2 & q : inner)
    {
      const auto near = toFixed(q);
      if (near.distance < gap)
      {
        if (PointInPolygon(q, fixed) != inside || near.distance < 1e-9)
        {
          inner = before;
          return -1;
        }
        q += (wanted - near.distance) / near.distance * (q - near.foot);
        good = false;
        ++moved;
      }
    }
    const NearestOnPolygon toInner(inner); // its boxes are a little behind; the last pass moves nothing
    for (const Vector2 & q : fixed)
    {
      const auto near = toInner(q);
      if (near.distance < gap)
      {
        if (near.distance < 1e-9)
        {
          inner = before;
          return -1;
        }
        Vector2 &     a = inner[near.edge];
        Vector2 &     b = inner[(near.edge + 1) % inner.size()];
        const double  t = near.along;
        const Vector2 shift =
          (wanted - near.distance) / near.distance / (t * t + (1.0 - t) * (1.0 - t)) * (near.foot - q);
        a += (1.0 - t) * shift;
        b += t * shift;
        good = false;
        ++moved;
      }
    }
    if (good)
    {
      return moved;
    }
  }
  inner = before;
  return -1;
}
} // namespace bone
