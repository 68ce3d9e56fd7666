/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePathPlanParameters_h
#define bonePathPlanParameters_h

#include "boneParameters.h"

namespace bone
{
// clang-format off
#define BONE_PATH_PLAN_PARAMETERS(value, flag) \
  value(double, margin, Margin, 2.0, ParameterRange::LengthOrZero(), "mm", "margin", \
    "Least bone that a safe path leaves between itself and the surface, beyond its entry") \
  value(double, shell, Shell, 2.0, ParameterRange::Length(), "mm", "shell", \
    "Thickness of the bone around the path whose density counts") \
  value(double, searchShift, SearchShift, 5.0, ParameterRange::LengthOrZero(), "mm", "search-shift", \
    "How far a search moves the entry, along either axis across the path") \
  value(double, searchAngle, SearchAngle, 0.17453292519943295, ParameterRange::Between(0.0, 0.7853981633974483), "rad", "search-angle", \
    "How far a search turns the path, about either axis across it") \
  value(double, searchDepth, SearchDepth, 5.0, ParameterRange::LengthOrZero(), "mm", "search-depth", \
    "How far a search lengthens or shortens the path")
// clang-format on

/** Parameters of PlanPath. */
BONE_PARAMETER_STRUCT(PathPlanParameters, BONE_PATH_PLAN_PARAMETERS);
} // namespace bone

#endif
