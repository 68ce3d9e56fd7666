/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneWallMerge_h
#define boneWallMerge_h

#include "boneTilingTypes.h"

namespace bone
{
namespace tiling
{
/** The wall between two walks round trees (medial axes, bridges), lower first: a sheet, met alike from both sides.
 * Main paths are merged by least span length; branches are matched where both trees have one at the same place, else
 * drawn together to a point. Walks round a hole, on either slice, are merged as closed contours. `variant` (0..) picks
 * another choice of main path or start. Returns false where there is no such variant. */
bool
MergeInnermostWalks(const std::vector<Vector2> & plane,
                    const Section &              lower,
                    const Section &              upper,
                    int                          variant,
                    Merge &                      wall);

/** Merges two closed contours by least span length; `variant` picks the start, false where there are no more. */
bool
MergeClosedWalks(const std::vector<Vector2> & plane, const Walk & lower, const Walk & upper, int variant, Merge & wall);

/** The longest path of a tree, from leaf to leaf, as vertex ids; a single vertex for a point. */
std::vector<int>
LongestPath(const std::vector<Vector2> & plane, const Walk & treeWalk);
} // namespace tiling
} // namespace bone

#endif
