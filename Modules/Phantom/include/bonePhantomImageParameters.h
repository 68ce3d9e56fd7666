/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePhantomImageParameters_h
#define bonePhantomImageParameters_h

#include "boneParameters.h"

#include <cstdint>

namespace bone
{
// clang-format off
#define BONE_PHANTOM_IMAGE_PARAMETERS(value, flag) \
  flag(fitToBone, FitToBone, true, "", "Size and origin are such that the bone lies inside") \
  value(double, margin, Margin, 5.0, ParameterRange::Between(0.0, 1e4), "mm", "margin", \
    "Least distance of the bone to the image's border") \
  value(double, noise, Noise, 0.0, ParameterRange::Between(0.0, 1e6), "HU", "noise", \
    "Standard deviation of the noise") \
  value(std::uint64_t, noiseSeed, NoiseSeed, 1, ParameterRange::NotNegative(), "", "", "Seed of the noise")
// clang-format on

/** Parameters of PhantomImageSource beside its grid and point spread. */
BONE_PARAMETER_STRUCT(PhantomImageParameters, BONE_PHANTOM_IMAGE_PARAMETERS);
} // namespace bone

#endif
