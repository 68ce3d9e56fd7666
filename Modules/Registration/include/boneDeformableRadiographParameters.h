/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDeformableRadiographParameters_h
#define boneDeformableRadiographParameters_h

#include "boneRadiographParameters.h"

namespace bone
{
// clang-format off
#define BONE_DEFORMABLE_RADIOGRAPH_PARAMETERS(value, flag) \
  value(double, searchTranslation, SearchTranslation, 10.0, ParameterRange::LengthOrZero(), "mm", "", \
    "How far the start may be off along each axis; 0, and SearchRotation 0 too: the mean is not searched for") \
  value(double, searchRotation, SearchRotation, 10.0, ParameterRange::Between(0.0, 180.0), "degrees", "", \
    "How far the start may be turned about each axis") \
  value(int, searchModes, SearchModes, 3, ParameterRange::Between(0, 20), "", "search-modes", \
    "Modes of shape that the search varies with the pose") \
  value(int, population, Population, 50, ParameterRange::Between(4, 10000), "", "population", \
    "Bones that the search tries at a time") \
  value(double, translationDeviation, TranslationDeviation, 0.0, ParameterRange::LengthOrZero(), "mm", \
    "translation-deviation", \
    "Prior: standard deviation of the start along each axis; 0, and RotationDeviation 0 too: no prior") \
  value(double, rotationDeviation, RotationDeviation, 0.0, ParameterRange::Between(0.0, 180.0), "degrees", \
    "rotation-deviation", "Prior: standard deviation of the start about each axis") \
  value(int, shapeModes, ShapeModes, 0, ParameterRange::Between(0, 10000), "", "shape-modes", \
    "Modes of shape at the most; 0: all of the atlas") \
  value(int, smoothModes, SmoothModes, 90, ParameterRange::Between(0, 3000), "", "smooth-modes", \
    "Modes of a smooth displacement beside those of the atlas") \
  value(double, smoothDeviation, SmoothDeviation, 0.0, ParameterRange::LengthOrZero(), "mm", "smooth-deviation", \
    "Standard deviation of a point's smooth displacement along each axis; 0: each mode's from the atlas, of what its subjects' shapes leave of one another") \
  value(double, smoothLength, SmoothLength, 0.0, ParameterRange::LengthOrZero(), "mm", "smooth-length", \
    "Length over which smooth displacements vary; 0: a twelfth of the bone's extent") \
  value(int, densityModes, DensityModes, 0, ParameterRange::Between(0, 10000), "", "density-modes", \
    "Modes of density at the most; 0: all of the atlas") \
  value(int, pixels, Pixels, 256, ParameterRange::Between(32, 4096), "pixels", "pixels", \
    "Longer side of the X-rays in the last steps") \
  value(int, searchPixels, SearchPixels, 128, ParameterRange::Between(32, 4096), "pixels", "search-pixels", \
    "Longer side of the X-rays in the first steps") \
  value(int, patch, Patch, 8, ParameterRange::Between(4, 1024), "pixels", "patch", \
    "Side of the patches in which gradients are compared") \
  value(double, sigma, Sigma, 1.0, ParameterRange::Between(0.3, 20.0), "pixels", "sigma", \
    "Standard deviation of the Gaussian of which gradients are taken") \
  flag(intensities, Intensities, true, "intensities", \
    "Compare line integrals too, not their gradients alone; they tell density") \
  value(double, attenuationSlope, AttenuationSlope, BoneSlopeAt60keV, ParameterRange::Positive(), "per mm and HU", \
    "attenuation-slope", "Rise of the attenuation with the density of bone") \
  value(double, softTissue, SoftTissue, 40.0, ParameterRange::Between(-1000.0, 3000.0), "HU", "soft-tissue", \
    "Density of what lies about the bone: the excess over it shows") \
  value(double, backgroundLength, BackgroundLength, 120.0, ParameterRange::Length(), "mm at the detector", \
    "background-length", "Distance of the knots of the splines that take up what lies about the bone") \
  value(double, gainDeviation, GainDeviation, 0.0, ParameterRange::Between(0.0, 1.0), "", "gain-deviation", \
    "Standard deviation of each view's factor of line integrals about 1; 0: they are exact") \
  value(double, surfaceDeviation, SurfaceDeviation, 0.2, ParameterRange::LengthOrZero(), "mm", "surface-deviation", \
    "Standard deviation of how far the model's surface lies outside the bone's as a whole; goes into the covariance") \
  value(int, iterations, Iterations, 12, ParameterRange::Between(1, 1000), "", "iterations", \
    "Steps at the most, at each resolution") \
  value(int, seed, Seed, 1, ParameterRange::Between(0, 1e9), "", "seed", "Seed of the search's random numbers")
// clang-format on

/** Parameters of DeformableRadiographRegistration. */
BONE_PARAMETER_STRUCT(DeformableRadiographParameters, BONE_DEFORMABLE_RADIOGRAPH_PARAMETERS);
} // namespace bone

#endif
