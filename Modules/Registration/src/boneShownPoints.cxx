/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneShownPoints.h"

#include "boneLandmarkProjection.h"

#include <algorithm>
#include <numeric>

namespace bone
{
namespace
{
bool
IsShown(const Vector3 & x, const LandmarkProjection & projection, const XRayGeometry::View & view, double beyond)
{
  Vector2                     place;
  Eigen::Matrix<double, 2, 3> derivatives;
  if (!projection.Project(x, place, &derivatives))
  {
    return false;
  }
  for (int axis = 0; axis < 2; ++axis)
  {
    const double margin = beyond * derivatives.row(axis).norm();
    const double last = view.spacing[axis] * (view.size[static_cast<std::size_t>(axis)] - 1);
    if (place[axis] < -margin || place[axis] > last + margin)
    {
      return false;
    }
  }
  return true;
}
} // namespace

std::vector<std::size_t>
ShownPoints(const std::vector<Vector3> &        points,
            const RigidPose &                   pose,
            const std::vector<RadiographView> & views,
            double                              beyond)
{
  std::vector<std::size_t> shown(points.size());
  std::iota(shown.begin(), shown.end(), std::size_t{ 0 });
  const std::vector<std::size_t> all = shown;
  for (const RadiographView & view : views)
  {
    const LandmarkProjection projection(view.view);
    shown.erase(
      std::remove_if(shown.begin(),
                     shown.end(),
                     [&](std::size_t p) { return !IsShown(pose.Apply(points[p]), projection, view.view, beyond); }),
      shown.end());
  }
  return shown.empty() ? all : shown;
}

Vector3
MeanOf(const std::vector<Vector3> & vectors, const std::vector<std::size_t> & which)
{
  Vector3 sum = Vector3::Zero();
  for (const std::size_t i : which)
  {
    sum += vectors[i];
  }
  return sum / static_cast<double>(which.size());
}
} // namespace bone
