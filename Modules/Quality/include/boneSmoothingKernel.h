/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSmoothingKernel_h
#define boneSmoothingKernel_h

#include "boneExecution.h"
#include "boneTetraComplex.h"
#include "boneTetraSmoothingParameters.h"

namespace bone
{
struct SmoothingReport
{
  std::size_t moves{ 0 };                    ///< over all iterations
  std::size_t weighted{ 0 };                 ///< moves that were weighted back before they were accepted
  std::size_t refused[MeshOperationCount]{}; ///< points left where they were, by the last reason
};

/** Smooths by Gauss-Seidel iteration in ascending order of points: the result depends on the input alone. Smart and
 * Enhanced need all cells positive, and keep them so. */
SmoothingReport
SmoothPoints(TetraComplex & complex, const TetraSmoothingParameters & parameters, const Execution & execution = {});
} // namespace bone

#endif
