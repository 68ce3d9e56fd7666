/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCorticalThicknessParameters_h
#define boneCorticalThicknessParameters_h

#include "boneParameters.h"

namespace bone
{
// clang-format off
#define BONE_CORTICAL_THICKNESS_PARAMETERS(value, flag) \
  value(double, pointSpread, PointSpread, 0.0, ParameterRange::LengthOrZero(), "mm", "point-spread", \
    "Full width at half maximum of the CT's blur; 0: estimated where the cortex is thick") \
  value(double, corticalDensity, CorticalDensity, 0.0, ParameterRange::NotNegative(), "HU", "cortical-density", \
    "Density of the cortex where it is thin; 0: the median of where it is thick") \
  value(double, depth, Depth, 10.0, ParameterRange::Length(), "mm", "depth", \
    "How far below the surface voxels are looked at: more than the thickest cortex") \
  value(double, radius, Radius, 1.5, ParameterRange::Length(), "mm", "radius", \
    "Voxels count whose nearest point of the surface is so near to the vertex, or a voxel and a half") \
  value(int, smoothingSteps, SmoothingSteps, 2, ParameterRange::AtLeast(0), "", "smoothing-steps", \
    "Steps that smooth the thickness over the surface; 0: as fitted, outliers too")
// clang-format on

/** Parameters of MapCorticalThickness. */
BONE_PARAMETER_STRUCT(CorticalThicknessParameters, BONE_CORTICAL_THICKNESS_PARAMETERS);
} // namespace bone

#endif
