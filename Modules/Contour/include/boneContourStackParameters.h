/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourStackParameters_h
#define boneContourStackParameters_h

#include "boneSnakeContourParameters.h"

#include <cstddef>

namespace bone
{
// clang-format off
#define BONE_CONTOUR_SLICE_PARAMETERS(value, flag) \
  value(double, meanSpacing, MeanSpacing, 0.0, ParameterRange::LengthOrZero(), "mm", "", \
    "Mean distance of the slices kept; 0: all are kept") \
  value(double, maximumGap, MaximumGap, 1.75, ParameterRange::AtLeast(1.0), "", "max-gap", \
    "Largest distance of neighbouring slices kept, in mean distances")

#define BONE_CONTOUR_RESAMPLE_PARAMETERS(value, flag) \
  value(double, tolerance, Tolerance, 0.2, ParameterRange::Length(), "mm", "tolerance", \
    "Largest distance of the given points to the spline, and of chords to it") \
  value(double, innerToleranceFactor, InnerToleranceFactor, 2.5, ParameterRange::Positive(), "", "inner-tolerance", \
    "Factor of the tolerance for the contours of inner layers") \
  value(double, minimumSpacing, MinimumSpacing, 0.8, ParameterRange::Length(), "mm", "least-spacing", \
    "Least distance of a contour's points") \
  value(double, maximumSpacing, MaximumSpacing, 4.0, ParameterRange::Length(), "mm", "contour-spacing", \
    "Largest distance of a contour's points") \
  value(double, minimumLayerDistance, MinimumLayerDistance, LeastLayerDistance, ParameterRange::LengthOrZero(), "mm", \
    "layer-distance", "Least distance between a contour and the next inside it") \
  value(double, thinLayerRatio, ThinLayerRatio, 6.0, ParameterRange::Positive(), "", "layer-ratio", \
    "Largest distance of points against the distance of the next contour") \
  value(std::size_t, targetNumberOfSamples, TargetNumberOfSamples, 0, ParameterRange::NotNegative(), "", "samples", \
    "Points of all closed contours, about; the spacings are scaled alike to give them; 0: as the spacings give") \
  value(std::size_t, targetNumberOfTetrahedra, TargetNumberOfTetrahedra, 0, ParameterRange::NotNegative(), "", "", \
    "The same for the tetrahedra of a tiling, as estimated")

#define BONE_MEDIAL_AXIS_PARAMETERS(value, flag) \
  value(double, spacing, Spacing, 0.0, ParameterRange::LengthOrZero(), "mm", "axis-spacing", \
    "Distance between samples of the axis; 0: the mean distance of the contour's points") \
  value(double, significance, Significance, 0.8, ParameterRange::Positive(), "", "axis-significance", \
    "An axis point counts where the contour between its two nearest points is longer than their straight distance by " \
    "more than this many times its clearance (a straight channel has infinity, a corner of 90 degrees 0.59)") \
  value(double, roundness, Roundness, 1.0, ParameterRange::NotNegative(), "", "axis-roundness", \
    "An axis without a cycle that is shorter than this many times its largest clearance is a point")
// clang-format on

/** Parameters of ContourSliceFilter. */
BONE_PARAMETER_STRUCT(ContourSliceParameters, BONE_CONTOUR_SLICE_PARAMETERS);
/** Parameters of ContourResampleFilter. */
BONE_PARAMETER_STRUCT(ContourResampleParameters, BONE_CONTOUR_RESAMPLE_PARAMETERS);
/** Parameters of MedialAxisFilter. */
BONE_PARAMETER_STRUCT(MedialAxisParameters, BONE_MEDIAL_AXIS_PARAMETERS);
} // namespace bone

#endif
