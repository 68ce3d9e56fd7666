/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTilingReport_h
#define boneTilingReport_h

#include "boneContourCorrespondence.h"

#include <string>
#include <vector>

namespace bone
{
/** What the tiling met and what it did about it. Counts of what is out of the ordinary are 0 for a plain stack. */
struct TilingReport
{
  int sections{ 0 };         ///< pieces of bone over all slices
  int slabs{ 0 };            ///< groups of corresponding pieces
  int branchings{ 0 };       ///< of these, with several pieces on one side
  int splitBranchings{ 0 };  ///< of these, knitted with parts of the one piece
  int filledBranchings{ 0 }; ///< of these, in slabs that were filled; all others were joined by bridges
  int splitFillings{ 0 };    ///< of those in filled slabs, with the one piece split
  int layerBranchings{ 0 };  ///< of the groups, with a layer on one side only
  int caps{ 0 };             ///< ends closed by a ridge
  int flatCuts{ 0 };         ///< ends left flat because the bone leaves the image
  int edgesRefined{ 0 };     ///< contour edges split because they were long against a thin layer
  int patches{ 0 };          ///< pieces triangulated without rings
  int loopsLeftOut{ 0 };     ///< inner contours left out because they lie in none, or in one of their own region
  int holesLeftOut{ 0 };     ///< holes left out because they lie in no bone
  int axesRecomputed{ 0 };   ///< medial axes that could not be used as given
  int alternativeKnits{ 0 }; ///< groups that needed the other diagonals or another start
  int otherAxes{ 0 };        ///< groups that needed another medial axis above
  int filledSlabs{ 0 };      ///< spaces between two slices filled by overlaying the triangulations of the slices
  int filledEnds{ 0 };       ///< ends closed in that way
  int separatedGroups{ 0 };  ///< groups in filled slabs whose pieces do not all overlap and so are not joined

  /** The pieces' correspondence in all slabs, as it was given or found. */
  ContourCorrespondence correspondence;

  /** The places behind the counts, in words ("slice 12: ..."). */
  std::vector<std::string> notes;
};
} // namespace bone

#endif
