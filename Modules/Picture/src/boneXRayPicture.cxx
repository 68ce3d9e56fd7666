/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneXRayPicture.h"

#include <Eigen/Geometry>

namespace bone
{
namespace
{
/** Across the detector, away from the source. */
Vector3
BeamOf(const XRayGeometry::View & view)
{
  const Vector3 normal = view.detectorU.cross(view.detectorV).normalized();
  const Vector3 along = view.parallel ? view.direction : Vector3(view.detectorOrigin - view.source);
  return along.dot(normal) < 0.0 ? Vector3(-normal) : normal;
}
} // namespace

SideLetters
LettersOf(const XRayGeometry::View & view)
{
  return LettersOf(view.detectorU, view.detectorV);
}

Vector2
PixelSizeAt(const XRayGeometry::View & view, const Vector3 & point)
{
  if (view.parallel)
  {
    return view.spacing;
  }
  const Vector3 beam = BeamOf(view);
  return view.spacing * ((point - view.source).dot(beam) / (view.detectorOrigin - view.source).dot(beam));
}

std::string
DescribeView(const XRayGeometry::View & view)
{
  const Vector3     beam = BeamOf(view);
  const std::string to = DirectionLetters(beam);
  const std::string from = DirectionLetters(-beam);
  if (to == "P" || to == "A")
  {
    return from + to + " view";
  }
  return std::string(to.size() > 1            ? "oblique"
                     : to == "L" || to == "R" ? "lateral"
                                              : "axial") +
         " view, beam from " + from + " to " + to;
}
} // namespace bone
