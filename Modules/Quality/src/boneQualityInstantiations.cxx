/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshQualityFilter.h"
#include "boneTetraSmoothingFilter.h"
#include "boneTetraSwapFilter.h"

namespace bone
{
template class TetraSmoothingFilter<DensityMesh<double>>;
template class TetraSwapFilter<DensityMesh<double>>;
template class MeshQualityFilter<DensityMesh<double>>;
} // namespace bone
