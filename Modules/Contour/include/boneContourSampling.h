/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourSampling_h
#define boneContourSampling_h

#include "boneClosedBSpline.h"
#include "boneContourStack.h"

namespace bone
{
/** Parameters of \ref SampleSlice, mm. */
struct SamplingParameters
{
  double tolerance{ 0.2 };       ///< of the spline to the contour's points, and of samples and chords to the spline
  double innerTolerance{ 2.5 };  ///< factor of the tolerance for inner layers
  double minimumSpacing{ 0.8 };  ///< between neighbouring samples
  double maximumSpacing{ 4.0 };  ///< between neighbouring samples
  double minimumDistance{ 0.8 }; ///< between a contour and the next inside it
  double thinLayerRatio{ 6.0 };  ///< spacing over the distance to the next layer, at most (but for minimumSpacing)
  double spacingScale{ 1.0 };    ///< factor of every spacing, limits too
};

/** How a slice's contours came out. */
struct SamplingReport
{
  int    samples{ 0 };        ///< on closed contours
  int    moved{ 0 };          ///< samples moved off their spline to keep the minimum distance
  int    near{ 0 };           ///< pairs of layers left nearer than the minimum distance, as they were given
  int    refined{ 0 };        ///< contours sampled more finely because they would have crossed or come too near
  int    unfitted{ 0 };       ///< contours kept as given: no spline could be had that stays clear of the others
  double largestError{ 0.0 }; ///< distance from a given point to its spline, mm
};

/** \brief Replaces the closed contours of a slice by samples of cubic B-splines fitted to them; axes are left out.
 *
 * Where the spline curves by k, samples lie sqrt(12 tolerance / k) apart, within the spacings' limits and the thin
 * layers'; the spacing changes by at most 0.3 per unit of length. The samples' polygon is the one nearest in the mean
 * square to the contour given: chords pass it on both sides, and areas are kept. Where chords bring a
 * contour nearer to the one around it (or to a hole beside it) than the minimum distance, the inner one is moved away.
 * What still conflicts is fitted and sampled more finely, then kept as given. The result is simple and
 * disjoint (decided exactly). Order, ids, layers and orientation are kept. */
ContourSlice
SampleSlice(const ContourSlice &       slice,
            const ContourStack &       frame,
            const SamplingParameters & parameters,
            SamplingReport &           report);

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
