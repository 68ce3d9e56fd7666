/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourSampling_h
#define boneContourSampling_h

#include "boneClosedBSpline.h"
#include "boneContourResampleFilter.h"

namespace bone
{
/** \brief Replaces the closed contours of a slice by samples of cubic B-splines fitted to them; axes are left out.
 *
 * Where the spline curves by k, samples lie sqrt(12 tolerance / k) apart, within the spacings' limits and the thin
 * layers'; the spacing changes by at most 0.3 per unit of length. The samples' polygon is the one nearest in the mean
 * square to the contour given: chords pass it on both sides, and areas are kept. Where chords bring a
 * contour nearer to the one around it (or to a hole beside it) than the minimum distance, the inner one is moved away.
 * What still conflicts is fitted and sampled more finely, then kept as given. The result is simple and
 * disjoint (decided exactly). Order, ids, layers and orientation are kept. `spacingScale` multiplies every spacing,
 * limits too. */
ContourSlice
SampleSlice(const ContourSlice &              slice,
            const ContourStack &              frame,
            const ContourResampleParameters & parameters,
            double                            spacingScale,
            SamplingReport &                  report);

/** Points of all closed contours. */
std::size_t
CountSamples(const ContourStack & stack);

/** About how many tetrahedra a tiling of the stack has: in each slab, 1.54 for each point of a layer's ring, on both
 * slices, and 1.79 for each point of an innermost contour, for the ring about its axis; measured, and good to a
 * quarter.
 */
double
EstimateTetrahedra(const ContourStack & stack);
} // namespace bone

#endif
