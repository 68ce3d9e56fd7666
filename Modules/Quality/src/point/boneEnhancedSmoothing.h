/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneEnhancedSmoothing_h
#define boneEnhancedSmoothing_h

#include "bonePointMover.h"
#include "boneSmoothingKernel.h"
#include "boneSurfaceTarget.h"

namespace bone
{
/** What Enhanced does with points of surfaces and curves. */
enum class SurfaceMotion : int
{
  Slide = 0,         ///< to the mean of their neighbours, put back on the faired surface
  ToFairedPlace = 1, ///< to where fairing alone puts them: samples stay as dense as they were where the surface curves
  None = 2
};

/** One Enhanced iteration towards a target made before. */
void
EnhancedIteration(TetraComplex &                   complex,
                  PointMover &                     mover,
                  const SurfaceTarget &            target,
                  const TetraSmoothingParameters & parameters,
                  SurfaceMotion                    motion,
                  SmoothingReport &                report);
} // namespace bone

#endif
