/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneImageResolutions_h
#define boneImageResolutions_h

#include "boneRadiographView.h"
#include "boneRigidPose.h"

#include <vector>

namespace bone
{
/** The longer sides of the X-rays that a registration goes through, in pixels: from searchPixels on, doubled until
 * `pixels`, the last. It begins with more where the points take up less than 0.6 of the longer side of an X-ray at the
 * start, as what counts is how fine an image shows the bone. */
std::vector<int>
ImageResolutions(int                                 searchPixels,
                 int                                 pixels,
                 const std::vector<Vector3> &        points,
                 const RigidPose &                   start,
                 const std::vector<RadiographView> & views);
} // namespace bone

#endif
