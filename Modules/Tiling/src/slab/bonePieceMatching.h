/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePieceMatching_h
#define bonePieceMatching_h

#include "boneContourCorrespondence.h"
#include "bonePieceOutline.h"

namespace bone
{
namespace tiling
{
/** Which pieces of a slice belong to which of the next. */
struct Group
{
  std::vector<int> lower;
  std::vector<int> upper;
};

/** Corresponding pieces of all slabs: result[k] of the pieces of slice k and k + 1 (paper 2.5). Slabs in `given` (which
 * may be null) are as it says. Others join
 * 1. pieces whose outer contours overlap;
 * 2. by distance, a piece without counterpart below and one without above, and
 * 3. a piece without counterpart and one that has some, where nothing else joins them anywhere: a piece that begins
 *    beside the body and runs into it further on is no handle.
 * A group is all pieces that such links connect, any number on both slices; a piece without counterpart is a group
 * of its own. Throws std::runtime_error where `given` names a contour that is not there, or twice. */
std::vector<std::vector<Group>>
MatchPieces(const std::vector<std::vector<PieceOutline>> & pieces,
            const std::vector<double> &                    heights,
            const ContourCorrespondence *                  given);
} // namespace tiling
} // namespace bone

#endif
