/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneXRayPicture_h
#define boneXRayPicture_h

#include "bonePlaneView.h"
#include "boneXRayGeometry.h"

#include <string>

namespace bone
{
/** \defgroup XRayPicture What a picture of an X-ray's view tells
 * \{ */

/** The patient's directions at the sides of the detector's image. */
SideLetters
LettersOf(const XRayGeometry::View & view);

/** What a column and a row of the detector see at a point's depth, mm: the spacing without the magnification. */
Vector2
PixelSizeAt(const XRayGeometry::View & view, const Vector3 & point);

/** "AP view", "PA view", "lateral view, beam from L to R", or "oblique view, beam from RA to LP": by the direction of
 * the beam across the detector; within 20 degrees of an axis it counts as along it. */
std::string
DescribeView(const XRayGeometry::View & view);
/** \} */
} // namespace bone

#endif
