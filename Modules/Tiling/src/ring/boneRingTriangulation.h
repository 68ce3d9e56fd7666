/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRingTriangulation_h
#define boneRingTriangulation_h

#include "boneTilingTypes.h"

namespace bone
{
namespace tiling
{
/** Triangulates the ring between an outer closed contour and an inner walk (loop, tree or point) with edges that span
 * from one to the other, by dynamic programming on span length and circumradius over several start pairs. All
 * triangles are counter-clockwise (exact). Returns the mean cost of a triangle (mm), infinite where no such
 * triangulation was found. */
double
TriangulateRing(const std::vector<Vector2> & plane, const Walk & outer, const Walk & inner, Merge & ring);

/** The ring between a walk and itself: no triangles. */
Merge
DegenerateRing(const Walk & walk);
} // namespace tiling
} // namespace bone

#endif
