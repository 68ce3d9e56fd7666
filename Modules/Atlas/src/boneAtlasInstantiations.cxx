/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasRegistrationFilter.h"
#include "boneStatisticalModelEstimator.h"

namespace bone
{
template class AtlasRegistrationFilter<DensityMesh<double>>;
template class StatisticalModelEstimator<DensityMesh<double>>;
} // namespace bone
