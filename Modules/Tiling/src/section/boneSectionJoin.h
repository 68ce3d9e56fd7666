/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSectionJoin_h
#define boneSectionJoin_h

#include "boneTilingTypes.h"

#include <set>
#include <utility>

namespace bone
{
namespace tiling
{
/** The same section with one ring for each of the regions (ascending, a superset of its own): a layer that it lacks
 * becomes a ring without extent about the next walk inward (paper 2.6, layer branching). */
Section
WithRegions(const Section & section, const std::vector<int> & regions);

/** Undirected edges, smaller id first. */
using EdgeSet = std::set<std::pair<int, int>>;

/** Joins sections of one plane, all with the same regions, by bridges between their closest vertices into one composite
 * section (paper 2.6, contour branching). A bridge runs on inward along spanning edges of the rings, so that the walks
 * of all layers that both have are joined. An edge serves one bridge only, `used` holds those taken: two bridges on one
 * edge, or the same one above and below a slice, would make four faces meet there. Returns false where no bridge was
 * found. */
bool
JoinSections(const std::vector<Vector2> & plane,
             const std::vector<Section> & sections,
             EdgeSet &                    used,
             Section &                    composite);

/** Ascending regions of all the sections. */
std::vector<int>
RegionsOf(const std::vector<Section> & sections);

/** The sections of one plane as one: aligned to the regions, joined where there are several. False where one has no
 * rings, or no bridge was found. */
bool
Compose(const std::vector<Vector2> & plane,
        const std::vector<Section> & sections,
        const std::vector<int> &     regions,
        EdgeSet &                    used,
        Section &                    composite);
} // namespace tiling
} // namespace bone

#endif
