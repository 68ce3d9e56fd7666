/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasVolumeParameters_h
#define boneAtlasVolumeParameters_h

#include "boneAtlasRegistrationParameters.h"

namespace bone
{
// clang-format off
#define BONE_ATLAS_VOLUME_PARAMETERS(value, flag) \
  value(MirrorMode, mirror, Mirror, MirrorMode::Never, ParameterRange::Any(), "", "mirror", \
    "Reflect the atlas, for a left bone of right ones: never, always, or try what fits better") \
  value(int, hypotheses, Hypotheses, 500000, ParameterRange::Between(1000, 1e9), "", "hypotheses", \
    "Places and directions that the search tries") \
  value(double, leastShare, LeastShare, 0.07, ParameterRange::Between(0.0, 1.0), "", "least-share", \
    "Least share of the bone that the CT shows") \
  value(int, shapeModes, ShapeModes, 0, ParameterRange::Between(0, 10000), "", "shape-modes", \
    "Modes of shape at the most; 0: all of the atlas") \
  value(int, smoothModes, SmoothModes, 300, ParameterRange::Between(0, 3000), "", "smooth-modes", \
    "Modes of a smooth displacement beside those of the atlas") \
  value(double, smoothLength, SmoothLength, 0.0, ParameterRange::LengthOrZero(), "mm", "smooth-length", \
    "Length over which smooth displacements vary; 0: a twenty-fourth of the bone's extent") \
  value(double, softTissue, SoftTissue, 40.0, ParameterRange::Between(-1000.0, 3000.0), "HU", "soft-tissue", \
    "Density of what lies about the bone") \
  value(double, boneThreshold, BoneThreshold, 150.0, ParameterRange::Any(), "HU", "bone-threshold", \
    "What never reaches it is no bone") \
  value(double, surfaceDeviation, SurfaceDeviation, 0.2, ParameterRange::LengthOrZero(), "mm", "surface-deviation", \
    "Standard deviation of how far the surface found lies outside the bone's as a whole; goes into the posterior") \
  value(int, seed, Seed, 1, ParameterRange::Between(0, 1e9), "", "seed", "Seed of the search's random numbers")
// clang-format on

/** Parameters of AtlasVolumeRegistration. */
BONE_PARAMETER_STRUCT(AtlasVolumeParameters, BONE_ATLAS_VOLUME_PARAMETERS);
} // namespace bone

#endif
