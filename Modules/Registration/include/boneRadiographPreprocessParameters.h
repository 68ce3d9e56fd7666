/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographPreprocessParameters_h
#define boneRadiographPreprocessParameters_h

#include "boneRadiographValues.h"

namespace bone
{
/** How display values become pseudo line integrals. */
enum class DisplayCurve : int
{
  Linear = 0,   ///< they are taken to be linear in the line integral
  Logarithm = 1 ///< they are taken to be linear in the photons
};

template <>
struct ParameterChoices<DisplayCurve>
{
  static constexpr std::array<const char *, 2> names = { "linear", "log" };
};

// clang-format off
#define BONE_RADIOGRAPH_PREPROCESS_PARAMETERS(value, flag) \
  value(RadiographValues, values, Values, RadiographValues::Integral, ParameterRange::Any(), "", "xray-values", \
    "What the X-ray's pixels are: integral (line integrals), intensity (photons), display (made to be looked at)") \
  value(double, openBeam, OpenBeam, 0.0, ParameterRange::NotNegative(), "units of the pixels", "i0", \
    "I0, the intensity without anything in the beam; 0: estimated from air") \
  value(DisplayCurve, displayCurve, DisplayCurve, DisplayCurve::Linear, ParameterRange::Any(), "", "display-curve", \
    "Display values are linear in: linear (the line integral), log (the photons)") \
  flag(largerAttenuates, LargerAttenuates, true, "larger-attenuates", \
    "Larger display values mean more attenuation, as where bone is bright") \
  value(std::vector<int>, crop, Crop, std::vector<int>(), ParameterRange::NotNegative(), "pixels", "crop", \
    "First column, first row, columns and rows that are used; none: all") \
  flag(detectCollimator, DetectCollimator, true, "collimator", \
    "Find the straight borders of the exposed field") \
  value(double, collimatorMargin, CollimatorMargin, 1.0, ParameterRange::Between(0, 20), \
    "% of the longer side", "collimator-margin", "Margin within the borders that is not used: their half-shadow") \
  value(double, deadPixelThreshold, DeadPixelThreshold, 8.0, ParameterRange::NotNegative(), \
    "standard deviations", "dead-pixels", \
    "Isolated pixels that differ so much from the median around them are dead; 0: none") \
  value(double, scatterToPrimary, ScatterToPrimary, 0.0, ParameterRange::Between(0, 3), "", "scatter", \
    "Scatter to primary photons behind the body; 0: none is subtracted") \
  value(double, scatterWidth, ScatterWidth, 50.0, ParameterRange::Length(), "mm at the detector", "scatter-width", \
    "Standard deviation of the blur that scatter has: some 20 degrees over 150 mm from body to detector") \
  value(double, leastPrimary, LeastPrimary, 0.02, ParameterRange::Above(0, 1), "", "least-primary", \
    "Share of a pixel's photons that is left as primary at least") \
  value(double, airWeight, AirWeight, 0.0, ParameterRange::Between(0, 1), "", "air-weight", \
    "Weight of pixels at or above I0, where the detector may be saturated; 1 for detectors that are not") \
  flag(quantumWeights, QuantumWeights, false, "quantum-weights", \
    "Weights by quantum noise, the inverse of a line integral's variance over that in the open beam")
// clang-format on

/** Parameters of RadiographPreprocessFilter. */
BONE_PARAMETER_STRUCT(RadiographPreprocessParameters, BONE_RADIOGRAPH_PREPROCESS_PARAMETERS);
} // namespace bone

#endif
