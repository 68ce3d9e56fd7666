/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePlaneView.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <numeric>
#include <sstream>

namespace bone
{
namespace
{
constexpr double Degree = 0.017453292519943295;

std::string
Number(double value, int digits)
{
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << (std::abs(value) < 0.5 * std::pow(10.0, -digits) ? 0.0 : value);
  return text.str();
}

std::string
Tuple(const Vector3 & v, int digits)
{
  return "(" + Number(v.x(), digits) + ", " + Number(v.y(), digits) + ", " + Number(v.z(), digits) + ")";
}

/** "z = -120.4 mm", or "12.3 mm along (0.00, 0.26, 0.97)". */
std::string
DescribePlace(const Vector3 & normal, const Vector3 & point)
{
  const int axis = PlaneAxis(normal);
  return axis >= 0 ? std::string(1, "xyz"[axis]) + " = " + Number(point[axis], 1) + " mm"
                   : Number(point.dot(normal), 1) + " mm along " + Tuple(normal, 2);
}

/** The axis of an image that is the normal within 0.1 degrees; -1 for none. */
int
ImageAxis(const itk::ImageBase<3> * image, const Vector3 & normal)
{
  for (unsigned int d = 0; d < 3; ++d)
  {
    const Vector3 column(image->GetDirection()(0, d), image->GetDirection()(1, d), image->GetDirection()(2, d));
    if (column.cross(normal).norm() < std::sin(0.1 * Degree))
    {
      return static_cast<int>(d);
    }
  }
  return -1;
}
} // namespace

std::string
DirectionLetters(const Vector3 & direction)
{
  constexpr std::array<const char *, 3> letters{ { "RL", "AP", "IS" } }; // towards less, towards more
  std::array<int, 3>                    order{ { 0, 1, 2 } };
  std::stable_sort(
    order.begin(), order.end(), [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  const double length = direction.norm();
  std::string  text;
  for (const int axis : { order[0], order[1] })
  {
    const bool told = text.empty() ? length > 0.0 : std::abs(direction[order[0]]) < std::cos(20.0 * Degree) * length;
    if (told)
    {
      text += letters[static_cast<std::size_t>(axis)][direction[axis] > 0.0 ? 1 : 0];
    }
  }
  return text;
}

SideLetters
LettersOf(const Vector3 & right, const Vector3 & down)
{
  return { DirectionLetters(-right), DirectionLetters(right), DirectionLetters(-down), DirectionLetters(down) };
}

int
PlaneAxis(const Vector3 & normal)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (normal.cross(Vector3::Unit(axis)).norm() < std::sin(0.1 * Degree))
    {
      return axis;
    }
  }
  return -1;
}

std::string
DescribePlane(const Vector3 & normal, const Vector3 & point)
{
  constexpr std::array<const char *, 3> names{ { "sagittal", "coronal", "axial" } };
  const int                             axis = PlaneAxis(normal);
  if (axis >= 0)
  {
    return std::string(names[static_cast<std::size_t>(axis)]) + " plane, " + DescribePlace(normal, point);
  }
  Eigen::Index nearest = 0;
  const double cosine = normal.cwiseAbs().maxCoeff(&nearest);
  const double angle = std::acos(std::min(1.0, cosine)) / Degree;
  return "oblique plane, " + Number(angle, angle < 9.95 ? 1 : 0) + "\u00B0 from " +
         names[static_cast<std::size_t>(nearest)] + ", through " + Tuple(point, 1) + " mm";
}

std::string
DescribeSlice(const itk::ImageBase<3> * ct, const Vector3 & normal, const Vector3 & point)
{
  constexpr double  same = 0.05; // of a slice
  const std::string place = DescribePlace(normal, point);
  const int         axis = ImageAxis(ct, normal);
  if (axis < 0)
  {
    return place;
  }
  itk::Point<double, 3> x;
  std::copy(point.data(), point.data() + 3, x.Begin());
  const auto   region = ct->GetLargestPossibleRegion();
  const auto   d = static_cast<unsigned int>(axis);
  const double index =
    ct->TransformPhysicalPointToContinuousIndex<double>(x)[d] - static_cast<double>(region.GetIndex(d));
  const double last = static_cast<double>(region.GetSize(d)) - 1.0;
  if (!(index > -same && index < last + same))
  {
    return place;
  }
  if (std::abs(index - std::round(index)) <= same)
  {
    return "CT slice " + Number(std::round(index), 0) + ", " + place;
  }
  return "between CT slices " + Number(std::floor(index), 0) + " and " + Number(std::ceil(index), 0) + ", " + place;
}
} // namespace bone
