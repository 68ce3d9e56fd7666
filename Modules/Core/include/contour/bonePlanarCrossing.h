/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePlanarCrossing_h
#define bonePlanarCrossing_h

#include "boneTypes.h"

#include <vector>

namespace bone
{
/** A polyline in a plane; a closed one does not repeat its first point. */
struct PlanarChain
{
  std::vector<Vector2> points;
  bool                 closed{ true };
};

/** Two chains that meet, and an edge of each (by the index of its first point); both chains may be the same. */
struct PlanarCrossing
{
  bool        found{ false };
  std::size_t chain[2]{ 0, 0 };
  std::size_t edge[2]{ 0, 0 };
};

/** \brief Looks for a place where a closed chain crosses or touches itself or another chain.
 *
 * Edges of one chain that follow each other meet in their common point only, else they count. Open chains may meet each
 * other. Decided exactly (\ref Orient2D); edges are found through a grid, so the work is O(n log n) for chains of about
 * evenly spaced points. Which one of several crossings is returned is fixed. \pre consecutive points differ. */
PlanarCrossing
FindPlanarCrossing(const std::vector<PlanarChain> & chains);
} // namespace bone

#endif
