/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourFlips_h
#define boneContourFlips_h

#include "boneContourSamples.h"
#include "bonePointMover.h"

#include <functional>

namespace bone
{
struct ContourFlipParameters
{
  double leastGain{ 1e-3 };   ///< mm^2 that the mean squared distance of the contours at the two triangles must fall by
  double cosineFloor{ 0.98 }; ///< of the dihedral angle that new cells may have, though old ones were better
};

/** \brief Flips edges of boundary and interfaces where the contours lie closer to the other two triangles.
 *
 * Four points of a curved surface are two pairs of triangles, one along a hollow and one across it; which is right is
 * nothing that angles tell (data-dependent triangulation: N. Dyn, D. Levin, S. Rippa, IMA J. Numer. Anal. 10, 1990).
 * Measured by the points of contours that belong to the two triangles, which must get closer by a tenth of their mean
 * squared distance and by `leastGain`. The mover's bound holds. `changed` is called with the cells that came. Returns
 * the number of flips. */
std::size_t
FlipToContours(TetraComplex &                                           complex,
               PointMover &                                             mover,
               const ContourSamples &                                   contours,
               const ContourFlipParameters &                            parameters,
               const std::function<void(const std::vector<IdType> &)> & changed = {});
} // namespace bone

#endif
