/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePolylines_h
#define bonePolylines_h

#include "boneContourStack.h"

#include <vector>

namespace bone
{
/** A contour that does not know its plane yet. */
struct Polyline
{
  Contour contour;
  int     slice{ -1 };        ///< -1: not given
  bool    hasRegion{ false }; ///< contour.region is that of the file
  bool    hasId{ false };     ///< contour.id is that of the file
};

/** Finds planes, slices and, where they are not given, ids, holes and directions of travel; see ReadContours. `normal`
 * and `u` may be zero: not given. Throws itk::ExceptionObject where it cannot. */
ContourStack::Pointer
StackPolylines(std::vector<Polyline> polylines, Vector3 normal, Vector3 u);

/** In-plane axes for a normal: U is the next coordinate axis, in cyclic order, after the one nearest to the normal,
 * brought into the plane (x for an axial stack). */
void
SetFrameFromNormal(ContourStack * stack, const Vector3 & normal);
} // namespace bone

#endif
