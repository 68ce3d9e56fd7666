/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePredicates_h
#define bonePredicates_h

#include "boneTypes.h"

namespace bone
{
/** Sign of the determinant |b-a, c-a, d-a|: +1 where (a, b, c, d) is a positively oriented tetrahedron (VTK's order: d
 * on the side of the normal of a, b, c counter-clockwise), -1 where it is inverted, 0 where the four points are exactly
 * coplanar. Exact for all finite doubles: a floating-point filter with Shewchuk's static error bound decides nearly
 * always, rational arithmetic the rest. J. R. Shewchuk, doi:10.1007/PL00009321. */
int
Orient3D(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);

/** Sign of |b-a, c-a| in the plane: +1 counter-clockwise, -1 clockwise, 0 exactly collinear. Exact as Orient3D. */
int
Orient2D(const Vector2 & a, const Vector2 & b, const Vector2 & c);

/** Sign of (b-a) x (d-c): +1 where the direction c->d lies to the left of a->b, 0 exactly parallel. Exact. */
int
CrossSign2D(const Vector2 & a, const Vector2 & b, const Vector2 & c, const Vector2 & d);

/** +1 where d lies inside the circle through a, b, c (counter-clockwise), -1 outside, 0 on it. Exact. */
int
InCircle2D(const Vector2 & a, const Vector2 & b, const Vector2 & c, const Vector2 & d);
} // namespace bone

#endif
