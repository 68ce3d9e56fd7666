/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStatisticalModelEstimator.h"

namespace bone
{
template class StatisticalModelEstimator<DensityMesh<double>>;
} // namespace bone
