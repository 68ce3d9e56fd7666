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
  double tolerance{ 0.2 };       ///< of the spline to the contour's points, and of a chord to the spline
  double minimumSpacing{ 0.8 };  ///< between neighbouring samples
  double maximumSpacing{ 4.0 };  ///< between neighbouring samples
  double minimumDistance{ 0.4 }; ///< between sampled contours, as far as those given keep it
  double thinLayerRatio{ 2.0 };  ///< spacing over the distance to the next layer, at most (but for minimumSpacing)
};

/** How a slice's contours came out. */
struct SamplingReport
{
  int    refined{ 0 };        ///< contours sampled more finely because they would have crossed or come too near
  int    unfitted{ 0 };       ///< contours kept as given: no spline could be had that stays clear of the others
  double largestError{ 0.0 }; ///< distance from a given point to its spline, mm
};

/** \brief Replaces the closed contours of a slice by samples of cubic B-splines fitted to them; axes are left out.
 *
 * Where the spline curves by k, samples lie sqrt(8 tolerance / k) apart, within the spacings' limits and the thin
 * layers'; the spacing changes by at most 0.3 per unit of length. Points lie on the spline. The result is simple and
 * disjoint (decided exactly).. Order,
 * ids, layers and orientation are kept. */
ContourSlice
SampleSlice(const ContourSlice &       slice,
            const ContourStack &       frame,
            const SamplingParameters & parameters,
            SamplingReport &           report);
} // namespace bone

#endif
