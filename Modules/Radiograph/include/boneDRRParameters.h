/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDRRParameters_h
#define boneDRRParameters_h

#include "boneRadiographParameters.h"

#include <limits>

namespace bone
{
// clang-format off
/** The tetrahedra that count: all where the mesh has no regions. */
#define BONE_REGION_RANGE_PARAMETERS(value, flag) \
  value(int, minimumRegion, MinimumRegion, std::numeric_limits<int>::min(), ParameterRange::Any(), "", \
    "minimum-region", "Lowest region of the mesh that counts") \
  value(int, maximumRegion, MaximumRegion, std::numeric_limits<int>::max(), ParameterRange::Any(), "", \
    "maximum-region", "Highest region of the mesh that counts")

#define BONE_DRR_ADJOINT_PARAMETERS(value, flag) \
  BONE_REGION_RANGE_PARAMETERS(value, flag) \
  BONE_ATTENUATION_LINE_PARAMETERS(value, flag)

#define BONE_MESH_RADIOGRAPH_PARAMETERS(value, flag) \
  BONE_REGION_RANGE_PARAMETERS(value, flag) \
  value(double, scale, Scale, 1.0, ParameterRange::Any(), "", "", "Factor of the density in what is integrated") \
  value(double, offset, Offset, 0.0, ParameterRange::Any(), "", "", "What is added to the scaled density") \
  flag(portable, Portable, false, "", "Use no instructions that not every processor of the family has")
// clang-format on

/** Parameters of DRRImageFilter beside those of RadiographSource. */
BONE_PARAMETER_STRUCT(DRRParameters, BONE_REGION_RANGE_PARAMETERS);

/** Parameters of DRRAdjointFilter. */
BONE_PARAMETER_STRUCT(DRRAdjointParameters, BONE_DRR_ADJOINT_PARAMETERS);

/** Parameters of the kernels: scale * density + offset is integrated in the tetrahedra of the regions. */
BONE_PARAMETER_STRUCT(MeshRadiographParameters, BONE_MESH_RADIOGRAPH_PARAMETERS);
} // namespace bone

#endif
