/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourFlips_h
#define boneContourFlips_h

#include "boneExecution.h"
#include "bonePointMover.h"
#include "boneSurfaceEnergy.h"

namespace bone
{
struct ContourFlipParameters
{
  double leastGain{ 1e-3 };   ///< mm^2, see FlipToContours
  double cosineFloor{ 0.98 }; ///< of the dihedral angle that new cells may have, though old ones were better
};

/** \brief Flips edges of boundary and interfaces where the contours lie closer to the other two triangles, or where the
 * dihedral deviation falls.
 *
 * Four points of a curved surface make two pairs of triangles, one along a hollow and one across it; angles alone do
 * not tell which is right (data-dependent triangulation: N. Dyn, D. Levin, S. Rippa, IMA J. Numer. Anal. 10, 1990).
 * What falls is the \ref SurfaceEnergy; it must fall by `leastGain` times the areas that the contours' points of the
 * two triangles stand for. The mover's bound holds. Returns the number of flips. */
std::size_t
FlipToContours(TetraComplex &                complex,
               PointMover &                  mover,
               SurfaceEnergy &               energy,
               const ContourFlipParameters & parameters,
               const Execution &             execution);
} // namespace bone

#endif
