/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityCalibrationParameters_h
#define boneDensityCalibrationParameters_h

#include "boneDensityQuantityChoices.h"

namespace bone
{
// clang-format off
#define BONE_DENSITY_CALIBRATION_PARAMETERS(value, flag) \
  value(std::vector<double>, line, Line, std::vector<double>(), ParameterRange::Any(), "", "line", \
    "Intercept and slope: density = intercept + slope * HU") \
  value(DensityQuantity, quantity, Quantity, DensityQuantity::Unknown, ParameterRange::Any(), "", "to", \
    "What the line or the references give: k2hpo4, ha (mg/cm3), ash, apparent (g/cm3)")
// clang-format on

/** Parameters of DensityCalibrationFilter that are numbers. */
BONE_PARAMETER_STRUCT(DensityCalibrationParameters, BONE_DENSITY_CALIBRATION_PARAMETERS);
} // namespace bone

#endif
