/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSolid_h
#define boneSolid_h

#include "boneTypes.h"

#include <optional>
#include <vector>

namespace bone
{
/** The points on the side of a plane that its normal points to, and the plane itself. */
struct HalfSpace
{
  Vector3 point{ Vector3::Zero() };   ///< on the plane, mm
  Vector3 normal{ Vector3::UnitZ() }; ///< of length 1
};

/** The points within `radius` of a segment; a ball where its ends are one point. */
struct Capsule
{
  Vector3 from{ Vector3::Zero() }; ///< mm
  Vector3 to{ Vector3::Zero() };   ///< mm
  double  radius{ 1.0 };           ///< mm

  /** Distance of x to the capsule's surface, mm; negative inside. A convex function. */
  double
  Distance(const Vector3 & x) const;
};

/** \struct Solid
 * \brief What a model is measured in: the intersection of half-spaces and at most one capsule.
 *
 * Neither: all of space. */
struct Solid
{
  std::vector<HalfSpace> halfSpaces;
  std::optional<Capsule> capsule;
};

/** Bound of the error of integrals over a round solid by default, as a share of what it holds. */
constexpr double DefaultSolidError = 2e-3;

/** \name Solids
 * Points in mm, in the space of the model. They throw std::invalid_argument where a number is not finite, a radius is
 * not positive, a normal is zero, or a cylinder has no length.
 * \{ */
/** `normal` points into the half-space; it may have any length but 0. */
Solid
MakeHalfSpace(const Vector3 & point, const Vector3 & normal);
Solid
MakeBall(const Vector3 & centre, double radius);
/** Round ends lie beyond `from` and `to`. */
Solid
MakeCapsule(const Vector3 & from, const Vector3 & to, double radius);
/** Flat ends lie at `from` and `to`. */
Solid
MakeCylinder(const Vector3 & from, const Vector3 & to, double radius);
/** \} */
} // namespace bone

#endif
