/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSolid.h"

#include "boneTriangleTree.h"

#include <stdexcept>

namespace bone
{
namespace
{
void
RequireFinite(const Vector3 & x, const char * what)
{
  if (!x.allFinite())
  {
    throw std::invalid_argument(std::string(what) + " has a coordinate that is not finite.");
  }
}
} // namespace

double
Capsule::Distance(const Vector3 & x) const
{
  return (x - ClosestPointOnSegment(x, from, to)).norm() - radius;
}

Solid
MakeHalfSpace(const Vector3 & point, const Vector3 & normal)
{
  RequireFinite(point, "A half-space's point");
  RequireFinite(normal, "A half-space's normal");
  if (!(normal.norm() > 0.0))
  {
    throw std::invalid_argument("A half-space's normal must not be zero.");
  }
  Solid solid;
  solid.halfSpaces.push_back({ point, normal.normalized() });
  return solid;
}

Solid
MakeCapsule(const Vector3 & from, const Vector3 & to, double radius)
{
  RequireFinite(from, "A solid's point");
  RequireFinite(to, "A solid's point");
  if (!(radius > 0.0 && std::isfinite(radius)))
  {
    throw std::invalid_argument("A solid's radius must be above 0 mm, but is " + std::to_string(radius) + ".");
  }
  Solid solid;
  solid.capsule = Capsule{ from, to, radius };
  return solid;
}

Solid
MakeBall(const Vector3 & centre, double radius)
{
  return MakeCapsule(centre, centre, radius);
}

Solid
MakeCylinder(const Vector3 & from, const Vector3 & to, double radius)
{
  const double length = (to - from).norm();
  Solid        solid = MakeCapsule(from, to, radius);
  if (!(length > 0.0))
  {
    throw std::invalid_argument("A cylinder's ends must not be one point.");
  }
  // The capsule's round ends lie beyond its flat ones.
  const Vector3 axis = (to - from) / length;
  solid.halfSpaces = { { from, axis }, { to, -axis } };
  return solid;
}
} // namespace bone
