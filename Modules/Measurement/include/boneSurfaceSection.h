/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceSection_h
#define boneSurfaceSection_h

#include "boneTriangleSurface.h"

#include <vector>

namespace bone
{
/** A closed curve in which a plane cuts a surface. */
struct SectionLoop
{
  std::vector<Vector3> points;                      ///< in order, the first not repeated, mm
  double               area{ 0.0 };                 ///< mm^2; negative for the rim of a hole
  Vector3              centroid{ Vector3::Zero() }; ///< of the area, mm

  /** Whether a point of the plane lies within the loop. */
  bool
  Holds(const Vector3 & x) const;

  /** Extent along a direction, mm. */
  double
  Width(const Vector3 & direction) const;
};

/** \brief The curves in which the plane through `point` with a normal (of length 1) cuts a closed surface.
 *
 * A vertex in the plane counts as being on the normal's side, so that curves are closed and simple. In the order of the
 * triangles. */
std::vector<SectionLoop>
CutSurface(const TriangleSurface & surface, const Vector3 & point, const Vector3 & normal);

/** \brief The curve with an area above 0 that holds the point, or else whose centroid is the nearest to it.
 *
 * `point` lies in the plane. Throws std::invalid_argument where the plane cuts nothing. */
SectionLoop
FindSection(const TriangleSurface & surface, const Vector3 & point, const Vector3 & normal);
} // namespace bone

#endif
