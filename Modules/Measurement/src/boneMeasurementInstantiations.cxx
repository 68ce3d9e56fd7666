/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCorticalThicknessFilter.h"

namespace bone
{
template class CorticalThicknessFilter<itk::Image<float, 3>, DensityMesh<double>>;
} // namespace bone
