/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshStorageParameters_h
#define boneMeshStorageParameters_h

#include "boneParameters.h"

namespace bone
{
// clang-format off
#define BONE_MESH_STORAGE_PARAMETERS(value, flag) \
  flag(compact, Compact, false, "compact", \
    "Models in a fraction of the space: the density rounded to 16 bits or fewer, points to single precision") \
  value(double, compactError, CompactError, 0.0, ParameterRange::NotNegative(), "density units", "compact-error", \
    "With --compact: by how much it may change the density anywhere; 0: as little as 16 bits can")
// clang-format on

/** How density meshes are written: exactly, or in the compact form (\ref MeshIO). */
BONE_PARAMETER_STRUCT(MeshStorageParameters, BONE_MESH_STORAGE_PARAMETERS);
} // namespace bone

#endif
