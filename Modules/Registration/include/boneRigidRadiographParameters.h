/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidRadiographParameters_h
#define boneRigidRadiographParameters_h

#include "boneParameters.h"

namespace bone
{
// clang-format off
#define BONE_RIGID_RADIOGRAPH_PARAMETERS(value, flag) \
  value(double, searchTranslation, SearchTranslation, 20.0, ParameterRange::LengthOrZero(), "mm", "", \
    "How far the start may be off along each axis; 0, and SearchRotation 0 too: only refined") \
  value(double, searchRotation, SearchRotation, 20.0, ParameterRange::Between(0.0, 180.0), "degrees", "", \
    "How far the start may be turned about each axis") \
  value(int, pixels, Pixels, 256, ParameterRange::Between(32, 4096), "pixels", "pixels", \
    "Longer side of the X-rays in the last step") \
  value(int, searchPixels, SearchPixels, 96, ParameterRange::Between(32, 4096), "pixels", "search-pixels", \
    "Longer side of the X-rays in the search, where the bone takes up most of it; more where it takes up little") \
  value(int, patch, Patch, 8, ParameterRange::Between(4, 1024), "pixels", "patch", \
    "Side of the patches in which gradients are compared") \
  value(double, sigma, Sigma, 1.0, ParameterRange::Between(0.3, 20.0), "pixels", "sigma", \
    "Standard deviation of the Gaussian of which gradients are taken") \
  value(int, population, Population, 40, ParameterRange::Between(4, 10000), "", "population", \
    "Poses that a search tries at a time") \
  value(int, searches, Searches, 6, ParameterRange::Between(1, 1000), "", "searches", \
    "Searches at the most; they end with one whose pose is distinct") \
  value(int, iterations, Iterations, 20, ParameterRange::Between(1, 1000), "", "iterations", \
    "Steps of the refinement at the most, at each resolution") \
  value(double, surfaceDeviation, SurfaceDeviation, 0.2, ParameterRange::LengthOrZero(), "mm", "surface-deviation", \
    "Standard deviation of how far the model's surface lies outside the bone's as a whole; goes into the covariance") \
  value(double, cutLength, CutLength, 25.0, ParameterRange::LengthOrZero(), "mm", "cut-length", \
    "Where the bone leaves the CT and the model ends in a flat cut, its density fades to nothing over this length") \
  value(double, viewTranslationDeviation, ViewTranslationDeviation, 0.0, ParameterRange::LengthOrZero(), "mm", \
    "view-translation-deviation", \
    "Standard deviation, along each axis, of where views after the first lie from where their geometry says; their motions are found along with the pose. 0, and ViewRotationDeviation 0 too: geometries are exact") \
  value(double, viewRotationDeviation, ViewRotationDeviation, 0.0, ParameterRange::Between(0.0, 30.0), "degrees", \
    "view-rotation-deviation", "The same of how views after the first are turned, about each axis") \
  value(int, seed, Seed, 1, ParameterRange::Between(0, 1e9), "", "seed", "Seed of the search's random numbers")
// clang-format on

/** Parameters of RigidRadiographRegistration. */
BONE_PARAMETER_STRUCT(RigidRadiographParameters, BONE_RIGID_RADIOGRAPH_PARAMETERS);
} // namespace bone

#endif
