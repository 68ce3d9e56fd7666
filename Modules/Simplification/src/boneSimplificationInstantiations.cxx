/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTetraCollapseFilter.h"

namespace bone
{
template class TetraCollapseFilter<DensityMesh<double>>;
} // namespace bone
