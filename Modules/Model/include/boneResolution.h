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
  double sliceStep{ 0.0 };      ///< mm; where slices are adaptive, on average
  double contourSpacing{ 0.0 }; ///< mm
};

/** Area (mm^2) of a bone's surface from its contours: their mean length on a slice times the height of the stack. */
double
EstimateSurface(const ContourStack & stack);

/** First guess for a number of tetrahedra: with slices `s` and samples at most `h` apart, N = 17 A / (s h) for a
 * surface of area A (measured; curved and thin places have more samples), and s = 0.4 h spends them best. A step below
 * the slices' own spacing becomes that spacing, the samples then being further apart. */
Resolution
EstimateResolution(double surfaceArea, double sliceSpacing, IdType tetrahedra);

/** About how many tetrahedra the quality stage leaves of a tiling with regions and neighbours. It collapses needles on
 * surfaces and fills the inside anew, so that the number goes with the surfaces' triangles, needles counting less. */
IdType
PredictQuality(const MeshArrays & tiled);

/** What may be changed to come to a number of tetrahedra. */
struct ResolutionSearch
{
  IdType tetrahedra{ 0 };
  double sliceSpacing{ 0.0 }; ///< of the image, mm; the slice step is not made smaller
  bool   sliceStepFixed{ false };
  bool   adaptive{ true }; ///< slices where sections change, the step being their mean; false: evenly spaced
};

/** Sets the slices and the contours' spacing. With adaptive slices the contours are made on those of the image, or on
 * every second, third, ... of them as far as that is within a quarter of the step, and then chosen from. */
void
SetResolution(BuildPipeline & pipeline, const Resolution & resolution, const ResolutionSearch & search);

/** Sets slice step and contour spacing of the pipeline, beginning with `start`, until the mesh has the number of
 * tetrahedra within 8 % after the quality stage: in at most three rounds of at most six tilings, which end where the
 * number that is predicted (\ref PredictQuality) is that of the search within 5 %.
 * Leaves the best ones set and the quality stage up to date. Far from the number both are changed, near it the spacing
 * alone, which leaves the contours as they are, unless that changes the number too little. Points do not come nearer
 * than a tenth of the slice step, where too few tetrahedra are left. A resolution at which the tiling fails is passed
 * over; the last failure is thrown where all fail. `tried`, where it is not empty, is told of each tiling and the
 * number predicted. */
Resolution
AdjustResolution(BuildPipeline &                                         pipeline,
                 const Resolution &                                      start,
                 const ResolutionSearch &                                search,
                 const std::function<void(const Resolution &, IdType)> & tried);
} // namespace bone

#endif
