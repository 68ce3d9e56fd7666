/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOwnFrame.h"

#include "boneSymmetricEigen.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace bone
{
namespace tiling
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double PlaceTolerance = 1e-6; // mm, within which coordinates are the same

/** In-plane axis of the contours themselves, so that a turned stack is tiled as it was: the direction of their largest
 * extent, toward the longer tail; the stack's own where they have none. */
Vector3
OwnAxis(const ContourStack & stack)
{
  constexpr double     leastDifference = 1e-3;
  std::vector<Vector2> points;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      for (std::size_t i = 0; i < contour.points.size() && !contour.axis; ++i)
      {
        points.push_back(stack.ToPlane(contour.points[i]));
      }
    }
  }
  // Sums in another order would give another axis in the last bit.
  std::sort(points.begin(), points.end(), [](const Vector2 & a, const Vector2 & b) {
    return std::lexicographical_compare(a.data(), a.data() + 2, b.data(), b.data() + 2);
  });
  Vector2 mean = Vector2::Zero();
  for (const Vector2 & q : points)
  {
    mean += q / static_cast<double>(points.size());
  }
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vector2 & q : points)
  {
    spread += (q - mean) * (q - mean).transpose();
  }
  const SymmetricEigenOf<2> axes = EigenOf(spread);
  const Vector2             values = axes.values;
  if (!(values[1] - values[0] > leastDifference * values[1]))
  {
    return stack.GetU();
  }
  const Vector2 axis = axes.vectors.col(1);
  double        tail = 0.0;
  for (const Vector2 & q : points)
  {
    tail += std::pow((q - mean).dot(axis), 3.0);
  }
  const double angle = std::atan2(axis.y(), axis.x()) + (tail < 0 ? Pi : 0.0);
  return stack.FromPlane({ std::cos(angle), std::sin(angle) }, 0.0);
}

/** The same contours in an order and with first points that depend on where they lie alone, in their own frame: turning
 * or renumbering a stack then changes nothing but the numbering, and what rounding does. */
ContourStack::Pointer
InOwnOrder(const ContourStack & stack)
{
  auto own = ContourStack::New();
  own->Graft(&stack);
  const Vector3 axis = OwnAxis(stack);
  own->SetFrame(axis, stack.GetNormal().cross(axis));
  const auto before = [&own](const Vector3 & p, const Vector3 & q) {
    const Vector2 a = own->ToPlane(p), b = own->ToPlane(q);
    return std::abs(a.x() - b.x()) > PlaceTolerance ? a.x() < b.x() : a.y() < b.y() - PlaceTolerance;
  };
  ContourStack::SliceContainer slices = own->GetSlices();
  for (ContourSlice & slice : slices)
  {
    for (Contour & contour : slice.contours)
    {
      auto & points = contour.points;
      if (!contour.axis)
      {
        std::rotate(points.begin(), std::min_element(points.begin(), points.end(), before), points.end());
      }
      else if (before(points.back(), points.front()))
      {
        std::reverse(points.begin(), points.end());
        std::reverse(contour.clearance.begin(), contour.clearance.end());
      }
    }
    std::stable_sort(slice.contours.begin(), slice.contours.end(), [&before](const Contour & a, const Contour & b) {
      // Branches of a medial axis begin where others do.
      return std::lexicographical_compare(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(), before);
    });
  }
  own->SetSlices(std::move(slices));
  return own;
}

double
Rounded(double value)
{
  constexpr double unit = 1e-8; // mm
  return unit * std::floor(value / unit + 0.5);
}
} // namespace

OwnFrame::OwnFrame(const ContourStack & stack, bool rounded)
  : m_Own(InOwnOrder(stack))
  , m_Stack(m_Own)
{
  if (!rounded)
  {
    return;
  }
  m_Stack = ContourStack::New();
  m_Stack->Graft(m_Own.GetPointer());
  m_Stack->SetFrame(Vector3::UnitX(), Vector3::UnitY());
  ContourStack::SliceContainer slices = m_Own->GetSlices();
  for (std::size_t k = 0; k < slices.size(); ++k)
  {
    const double height = Rounded(m_Own->GetHeight(k));
    slices[k].origin = Vector3(0, 0, height);
    for (Contour & contour : slices[k].contours)
    {
      for (Vector3 & p : contour.points)
      {
        const Vector2 q = m_Own->ToPlane(p);
        const Vector3 placed(Rounded(q.x()), Rounded(q.y()), height);
        m_Given.emplace(std::array<double, 3>{ { placed.x(), placed.y(), placed.z() } }, p);
        p = placed;
      }
    }
  }
  m_Stack->SetSlices(std::move(slices));
}

Vector3
OwnFrame::ToSpace(const Vector3 & p) const
{
  return m_Stack == m_Own ? p : m_Own->FromPlane({ p.x(), p.y() }, p.z());
}

Vector3
OwnFrame::ToGivenPlace(const Vector3 & p) const
{
  const auto given = m_Given.find({ { p.x(), p.y(), p.z() } });
  return given != m_Given.end() ? given->second : this->ToSpace(p);
}
} // namespace tiling
} // namespace bone
