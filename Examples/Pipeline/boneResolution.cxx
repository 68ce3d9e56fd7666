/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneResolution.h"

#include <algorithm>
#include <cmath>
#include <exception>

namespace bone
{
Resolution
EstimateResolution(double surfaceArea, double sliceSpacing, IdType tetrahedra)
{
  constexpr double ratio = 0.6;
  const double     product = 9.5 * surfaceArea / static_cast<double>(tetrahedra);
  Resolution       resolution;
  resolution.sliceStep = std::max(sliceSpacing, std::sqrt(ratio * product));
  resolution.contourSpacing = product / resolution.sliceStep;
  return resolution;
}

double
AdjustContourSpacing(BuildPipeline &                             pipeline,
                     double                                      spacing,
                     IdType                                      tetrahedra,
                     const std::function<void(double, IdType)> & tried)
{
  constexpr double   tolerance = 0.08;
  constexpr int      maximumTrials = 6;
  std::exception_ptr failure;
  double             best = 0.0;
  double             bestError = 0.0;
  for (int trial = 0; trial < maximumTrials; ++trial)
  {
    try
    {
      pipeline.SetContourSpacing(spacing);
      pipeline.GetTiling()->Update();
    }
    catch (const itk::ProcessAborted &)
    {
      throw;
    }
    catch (const itk::ExceptionObject &)
    {
      failure = std::current_exception();
      spacing *= 0.94;
      continue;
    }
    const IdType count = pipeline.GetTiling()->GetOutput()->GetNumberOfTetrahedra();
    tried(spacing, count);
    const double ratio = static_cast<double>(count) / static_cast<double>(tetrahedra);
    const double error = std::abs(std::log(ratio));
    if (best == 0.0 || error < bestError)
    {
      best = spacing;
      bestError = error;
    }
    if (std::abs(ratio - 1.0) <= tolerance)
    {
      break;
    }
    // On fixed slices the number of tetrahedra goes with the number of samples, 1 / spacing.
    spacing *= std::clamp(ratio, 0.4, 2.5);
  }
  if (best == 0.0)
  {
    std::rethrow_exception(failure);
  }
  pipeline.SetContourSpacing(best);
  return best;
}
} // namespace bone
