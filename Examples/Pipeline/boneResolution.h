/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneResolution_h
#define boneResolution_h

#include "boneBuildPipeline.h"

#include <functional>

namespace bone
{
/** How densely a bone is sampled. */
struct Resolution
{
  double sliceStep{ 0.0 };      ///< mm
  double contourSpacing{ 0.0 }; ///< mm
};

/** First guess for a number of tetrahedra. A tiled mesh has about 5.3 tetrahedra a contour point, and the inner layers
 * have about 0.8 times as many points as the outer one: with slices `s` and samples `h` apart, N = 9.5 A / (s h) for a
 * surface of area A, and s = 0.6 h keeps the cells well shaped. A step below the slices' own spacing becomes that
 * spacing, the samples then being further apart. */
Resolution
EstimateResolution(double surfaceArea, double sliceSpacing, IdType tetrahedra);

/** Changes the pipeline's contour spacing until its tiling has the number of tetrahedra within 8 %, in at most six
 * tilings, and leaves the best one set. A spacing at which the tiling fails is passed over; the last failure is thrown
 * where all fail. `tried` is told of each. Returns the spacing. */
double
AdjustContourSpacing(BuildPipeline &                             pipeline,
                     double                                      spacing,
                     IdType                                      tetrahedra,
                     const std::function<void(double, IdType)> & tried);
} // namespace bone

#endif
