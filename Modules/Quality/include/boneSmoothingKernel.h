/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSmoothingKernel_h
#define boneSmoothingKernel_h

#include "bonePointMover.h"
#include "boneSurfaceTarget.h"

#include <functional>

namespace bone
{
enum class SmoothingMethod : int
{
  Laplacian = 0, ///< every point to the mean of its neighbours; shrinks, and may invert cells
  Smart = 1,     ///< the same, but a point stays where a cell would invert
  Enhanced = 2 ///< means along the point's own surface, put back on it; weighted back until no cell inverts (paper 2.7)
};

/** What Enhanced does with points of surfaces and curves. */
enum class SurfaceMotion : int
{
  Slide = 0,         ///< to the mean of their neighbours, put back on the faired surface
  ToFairedPlace = 1, ///< to where fairing alone puts them: samples stay as dense as they were where the surface curves
  None = 2
};

struct SmoothingParameters
{
  SmoothingMethod method{ SmoothingMethod::Enhanced };
  int             iterations{ 10 };
  double          distanceBound{ 0.3 }; ///< mm, how far boundary and interfaces may be faired
  int             fairingIterations{ 10 };
  double          weight{ 0.5 }; ///< the paper's alpha, in (0, 1): share of the old place in each step back
  SurfaceMotion   surfaceMotion{ SurfaceMotion::Slide };
  double          angleFloor{ 0.14 }; ///< rad; no move takes a dihedral angle below this and below what it was
};

struct SmoothingReport
{
  std::size_t moves{ 0 };                    ///< over all iterations
  std::size_t weighted{ 0 };                 ///< moves that were weighted back before they were accepted
  std::size_t refused[MeshOperationCount]{}; ///< points left where they were, by the last reason
};

/** Called after each iteration with the fraction done; it may throw to stop. */
using ProgressFunction = std::function<void(double)>;

/** Smooths by Gauss-Seidel iteration in ascending order of points: the result depends on the input alone. Smart and
 * Enhanced need all cells positive, and keep them so. */
SmoothingReport
SmoothPoints(TetraComplex & complex, const SmoothingParameters & parameters, const ProgressFunction & progress = {});

/** One Enhanced iteration towards a target made before. */
void
EnhancedIteration(TetraComplex &              complex,
                  PointMover &                mover,
                  const SurfaceTarget &       target,
                  const SmoothingParameters & parameters,
                  SmoothingReport &           report);

} // namespace bone

#endif
