/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTilingReport_h
#define boneTilingReport_h

#include <string>
#include <vector>

namespace bone
{
/** What the tiling met and how it got through; all counts are 0 in the plain case. */
struct TilingReport
{
  int sections{ 0 };           ///< pieces of bone over all slices
  int slabs{ 0 };              ///< pairs of corresponding pieces knitted
  int branchings{ 0 };         ///< of these, with several pieces on one side (composite contours)
  int layerBranchings{ 0 };    ///< of these, with a layer on one side only
  int caps{ 0 };               ///< ends closed by a ridge or an apex
  int flatCuts{ 0 };           ///< ends left flat because the bone leaves the image
  int edgesRefined{ 0 };       ///< contour edges split because they were long against a thin layer
  int loopsLeftOut{ 0 };       ///< inner contours left out (second of a layer, or not triangulable)
  int holesLeftOut{ 0 };       ///< holes closed (second of a piece, or not triangulable)
  int axesRecomputed{ 0 };     ///< medial axes that could not be used as given
  int alternativeKnits{ 0 };   ///< slabs that needed the other diagonals or another start
  int otherAxes{ 0 };          ///< slabs that needed another medial axis above
  int piecesLeftOut{ 0 };      ///< small pieces of a single slice left out because they could not be joined
  int intermediateSlices{ 0 }; ///< planes inserted between two slices to make a slab feasible
  int starFillings{ 0 };       ///< slabs filled from one interior vertex

  /** The places behind the counts, in words ("slice 12: ..."). */
  std::vector<std::string> notes;
};
} // namespace bone

#endif
