/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRingKnit_h
#define boneRingKnit_h

#include "boneTilingMetric.h"
#include "boneTilingTypes.h"
#include "boneWallGuide.h"

namespace bone
{
namespace tiling
{
struct TiledTetra
{
  Id4 vertices;
  int region;
};

/** The two triangulated rings that a knit joins. */
struct RingPair
{
  const Walk &  outerLower;
  const Walk &  innerLower;
  const Merge & ringLower;
  const Walk &  outerUpper;
  const Walk &  innerUpper;
  const Merge & ringUpper;
};

struct RingKnit
{
  bool made{ false };       ///< there is a valid knit for this start
  bool moreStarts{ false }; ///< there are further starts
  bool departs{ false };    ///< its outer wall departs from where it should run by more than the guide's limit
};

/** \brief Knits the triangulated ring of a slice with that of the next into tetrahedra (paper 2.2, second step).
 *
 * The knit is a cyclic merge of the two rings' words, each step advancing the outer or inner walk below or above. The
 * wall between the inner walks is prescribed by `inner` (continuity between layers, paper 2.4), which also bounds the
 * search to a band: cost is linear in the ring's length. The quadrilateral between two spanning edges is cut by one of
 * its diagonals; changing to the other one adds a tetrahedron of its own. Dynamic programming minimises the metric's
 * sum, and how far the wall between the outer walks departs from where `guide` has it, over the knits all of whose
 * tetrahedra are positive (exact). `start` (0..) picks another pair of spanning edges to begin with.
 *
 * Where it is made, `outer` is the wall between the outer walks and the tetrahedra are appended. */
RingKnit
KnitRing(const VertexPool &        pool,
         const RingPair &          rings,
         const Merge &             inner,
         const TilingMetric &      metric,
         const WallGuide &         guide,
         int                       start,
         int                       region,
         Merge &                   outer,
         std::vector<TiledTetra> & tetrahedra);
} // namespace tiling
} // namespace bone

#endif
