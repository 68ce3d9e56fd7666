/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityCalibrationFilter.h"
#include "boneDensityFitFilter.h"
#include "boneDensityImageFilter.h"

namespace bone
{
template class DensityCalibrationFilter<itk::Image<float, 3>, DensityMesh<double>>;
template class DensityFitFilter<itk::Image<float, 3>, DensityMesh<double>>;
template class DensityImageFilter<DensityMesh<double>, itk::Image<float, 3>>;
} // namespace bone
