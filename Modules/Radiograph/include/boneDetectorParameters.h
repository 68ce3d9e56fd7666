/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDetectorParameters_h
#define boneDetectorParameters_h

#include "boneParameters.h"

#include <cstdint>

namespace bone
{
// clang-format off
#define BONE_INTENSITY_PARAMETERS(value, flag) \
  value(double, incidentIntensity, IncidentIntensity, 1.0, ParameterRange::Positive(), "photons a pixel", "intensity", \
    "Write what a detector sees of this many photons a pixel, not the line integrals")

#define BONE_NOISE_PARAMETERS(value, flag) \
  value(double, photonsPerUnit, PhotonsPerUnit, 1.0, ParameterRange::NotNegative(), "", "photons-per-unit", \
    "Photons of an intensity of 1; 0: no quantum noise") \
  value(double, electronicNoise, ElectronicNoise, 0.0, ParameterRange::NotNegative(), "units of the intensity", \
    "electronic-noise", "Standard deviation of the electronic noise") \
  value(std::uint64_t, seed, Seed, 1, ParameterRange::Any(), "", "noise", "Seed of quantum noise")
// clang-format on

/** Parameters of IntensityImageFilter. */
BONE_PARAMETER_STRUCT(IntensityParameters, BONE_INTENSITY_PARAMETERS);

/** Parameters of NoiseImageFilter. */
BONE_PARAMETER_STRUCT(NoiseParameters, BONE_NOISE_PARAMETERS);
} // namespace bone

#endif
