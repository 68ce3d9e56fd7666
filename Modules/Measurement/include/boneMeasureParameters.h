/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeasureParameters_h
#define boneMeasureParameters_h

#include "boneParameters.h"
#include "boneSolid.h"

namespace bone
{
// clang-format off
#define BONE_MEASURE_PARAMETERS(value, flag) \
  value(double, solidError, SolidError, DefaultSolidError, ParameterRange::Above(0.0, 1.0), "share", "solid-error", \
    "Bound of the error of volume and mass in a round solid, of what it holds") \
  value(double, landmarkReach, LandmarkReach, 20.0, ParameterRange::LengthOrZero(), "mm", "landmark-reach", \
    "A landmark further outside the bone than this is of a part that is not there")
// clang-format on

/** Parameters of MeasureModel. */
BONE_PARAMETER_STRUCT(MeasureParameters, BONE_MEASURE_PARAMETERS);
} // namespace bone

#endif
