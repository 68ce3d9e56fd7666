/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageResolutions.h"

#include "boneLandmarkProjection.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
/** The share of the longer side of an X-ray that the points take up at a pose, where that is least. */
double
ShareOfXRay(const std::vector<Vector3> & points, const RigidPose & pose, const std::vector<RadiographView> & views)
{
  double least = 1.0;
  for (const RadiographView & view : views)
  {
    const LandmarkProjection projection(view.view);
    Eigen::AlignedBox2d      box;
    Vector2                  place;
    for (const Vector3 & x : points)
    {
      if (projection.Project(pose.Apply(x), place))
      {
        box.extend(place);
      }
    }
    const double side = std::max(view.view.size[0] * view.view.spacing[0], view.view.size[1] * view.view.spacing[1]);
    least = box.isEmpty() ? least : std::min(least, box.sizes().maxCoeff() / side);
  }
  return least;
}
} // namespace

std::vector<int>
ImageResolutions(int                                 searchPixels,
                 int                                 pixels,
                 const std::vector<Vector3> &        points,
                 const RigidPose &                   start,
                 const std::vector<RadiographView> & views)
{
  // On 96 pixels, a hip bone that took up a third of them was called `ok` 2 mm and 3 degrees from its place.
  constexpr double enough = 0.6;
  const double     wanted = searchPixels * std::max(1.0, enough / ShareOfXRay(points, start, views));
  std::vector<int> resolutions;
  for (long side = std::lround(std::min<double>(pixels, wanted)); side < pixels; side *= 2)
  {
    resolutions.push_back(static_cast<int>(side));
  }
  resolutions.push_back(pixels);
  return resolutions;
}
} // namespace bone
