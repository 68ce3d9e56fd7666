/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSectionSplit_h
#define boneSectionSplit_h

#include "boneSectionJoin.h"
#include "boneTilingTypes.h"

#include <set>
#include <vector>

namespace bone
{
namespace tiling
{
/** What cuts run through: edges of a slice's triangulation, and the vertices of the slice's inside that they meet. */
struct CutTrace
{
  EdgeSet       edges;
  std::set<int> vertices;

  void
  Add(const CutTrace & other);
};

/** \brief Splits a section into as many parts as it has counterparts on another slice (paper 2.6, contour branching).
 *
 * A cut runs from the outer contour along spanning edges of the rings to a vertex of the medial axis and on to the
 * outer contour again. Each part is a section: its outer walk goes along the contour and back along the cut, and so do
 * the walks of the layers inside, which meet the cut where the spanning edges do; its innermost walk goes round the
 * medial axis on its side of the cut. The parts' triangles are the section's, each in one part, so that the other slab
 * at the slice sees no change.
 *
 * Of all cuts one is taken whose part lies nearest to its counterpart: least is the sum over the part's triangles of
 * area times (distance to the counterpart - distance to the nearest other one), the distances being signed and the
 * counterparts moved together by the way of the centroids, plus a term for the cut's length. With more than two
 * counterparts one part after the other is cut off. A cut shares no edge and, inside the outer contour, no vertex with
 * those in `taken`: four faces would meet there, or two surfaces at a vertex.
 *
 * \param counterparts  outer contours of the counterparts
 * \param made          trace of the cuts
 * \param parts         parts[i] belongs to counterparts[i]
 *
 * Returns false for a section without rings or round a hole, and where no cut was found. */
bool
SplitSection(const std::vector<Vector2> &              plane,
             const Section &                           section,
             const std::vector<std::vector<Vector2>> & counterparts,
             const CutTrace &                          taken,
             CutTrace &                                made,
             std::vector<Section> &                    parts);
} // namespace tiling
} // namespace bone

#endif
