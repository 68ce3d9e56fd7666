/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFacetFit_h
#define boneFacetFit_h

#include "boneDirectedSurface.h"
#include "boneExecution.h"

namespace bone
{
/** Parameters of \ref FitFacets. */
struct FacetFitParameters
{
  std::vector<int> smoothing{ 0, 0 }; ///< one a pass: how often the moves are averaged over neighbours
  double           bound{ 0.5 };      ///< how far a vertex may move in all passes, mm
  double           reach{ 5.0 };      ///< farther off the target is none, mm
};

/** \brief Moves vertices along their normals so that the facets, not the vertices, lie on the target.
 *
 * A surface whose vertices lie on a bone cuts off its bulges and fills its hollows by the sagitta of its facets, which
 * takes mass off the bone. Each pass moves a vertex by the mean signed distance of the facets around it, at seven
 * places of each, weighted by its shape function and their area; two passes are near enough to the least-squares
 * solution from nearby. Moves are smoothed over the surface first where it is farther off. Vertices with a mark in
 * `fixed` (empty: none) stay. The same for any number of threads. */
void
FitFacets(TriangleSurface &          surface,
          const DirectedSurface &    target,
          const FacetFitParameters & parameters,
          const std::vector<char> &  fixed = {},
          const Execution &          execution = {});
} // namespace bone

#endif
