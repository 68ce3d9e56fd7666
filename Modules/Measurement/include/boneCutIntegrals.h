/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCutIntegrals_h
#define boneCutIntegrals_h

#include "boneExecution.h"
#include "boneMeshArrays.h"
#include "boneSolid.h"

#include <vector>

namespace bone
{
/** What a part of a model holds. */
struct PartDensity
{
  int    region{ -1 };       ///< -1: all regions
  double volume{ 0.0 };      ///< mm^3
  double mass{ 0.0 };        ///< integral of the density, density units times mm^3; NaN without a density
  double mean{ 0.0 };        ///< density units; NaN without a density or volume
  double volumeError{ 0.0 }; ///< mm^3, bound of |error| up to rounding
  double massError{ 0.0 };   ///< density units times mm^3, bound of |error| up to rounding
};

/** The part of a model in a solid. */
struct SolidDensity
{
  PartDensity              total;
  std::vector<PartDensity> regions; ///< one for each region of the mesh, ascending; 0 where a part is empty
};

/** \brief Volume, mass and mean density of the part of a mesh that lies in a solid, by region and in all.
 *
 * Planes cut exactly: a plane splits a tetrahedron into tetrahedra, on which the polynomial's Bernstein coefficients
 * follow by blossoming, and the integral is volume times their mean. A capsule, which is convex, is bounded from inside
 * and outside: in a piece of a tetrahedron the linear interpolant of its distance d at the corners is never below d,
 * and above it by R^2 / (2 rho) at most, R the radius of a ball around the piece and rho the least distance to the
 * capsule's axis (no second derivative of d is above 1 / rho). Pieces that the surface may pass are bisected at their
 * longest edge, those with the largest bounds first, until the bounds' sum is at most `relativeError` of the volume.
 * A mass' bound is that of the volume times the tetrahedron's largest absolute coefficient; their sum is brought to
 * `relativeError` of the volume weighted with each tetrahedron's mean density, which is about the mass where no density
 * is negative. Where the surface passes more than `mostPieces` pieces the error is left as it is then stated.
 *
 * The result does not depend on the number of threads. Inverted tetrahedra count negatively, as in MeasureRegions.
 *
 * \param mesh           with or without density and regions (without: all is region 0).
 * \param relativeError  above 0; for a capsule only.
 * Throws std::invalid_argument where relativeError is not above 0. */
SolidDensity
IntegrateSolid(const MeshArrays & mesh,
               const Solid &      solid,
               double             relativeError = DefaultSolidError,
               const Execution &  execution = {},
               std::size_t        mostPieces = 500000);
} // namespace bone

#endif
