/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityImageParameters_h
#define boneDensityImageParameters_h

#include "boneParameters.h"

namespace bone
{
// clang-format off
#define BONE_DENSITY_IMAGE_PARAMETERS(value, flag) \
  value(double, outsideValue, OutsideValue, -1024.0, ParameterRange::Any(), "density units", "outside", \
    "Value outside the model")
// clang-format on

/** Parameters of DensityImageFilter beside its grid. */
BONE_PARAMETER_STRUCT(DensityImageParameters, BONE_DENSITY_IMAGE_PARAMETERS);
} // namespace bone

#endif
