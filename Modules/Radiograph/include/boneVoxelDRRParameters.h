/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVoxelDRRParameters_h
#define boneVoxelDRRParameters_h

#include "boneParameters.h"

namespace bone
{
// clang-format off
#define BONE_VOXEL_DRR_PARAMETERS(value, flag) \
  value(int, maskLabel, MaskLabel, 0, ParameterRange::Any(), "", "mask-label", \
    "Label of the mask's voxels that count; 0: any label but 0") \
  flag(aboveAir, AboveAir, false, "above-air", \
    "Count what a voxel has above air, max(0, HU + 1000), where HU are not turned into attenuation")
// clang-format on

/** Parameters of VoxelDRRImageFilter beside those of RadiographSource. */
BONE_PARAMETER_STRUCT(VoxelDRRParameters, BONE_VOXEL_DRR_PARAMETERS);
} // namespace bone

#endif
