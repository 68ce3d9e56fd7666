/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSection_h
#define boneSection_h

#include "boneContourStack.h"
#include "bonePlaneField.h"

#include <string>

namespace bone
{
/** \brief One piece of bone on a slice: a periosteal loop with what lies in it. */
struct SectionPiece
{
  Polygon              outer;     ///< counter-clockwise
  std::vector<Polygon> holes;     ///< clockwise
  std::vector<Polygon> endosteal; ///< counter-clockwise, within outer, beside each other and the holes
  std::vector<Polygon> medullary; ///< counter-clockwise, each within an endosteal one
};

/** \brief The pieces of bone on one slice, in plane coordinates (mm). */
struct Section
{
  double                    height{ 0.0 }; ///< along the stack's normal, mm
  std::vector<SectionPiece> pieces;
};

/** Pieces from contours of a level set: each clockwise contour becomes a hole of the smallest counter-clockwise one
 * that holds it; contours of less than `minimumArea` (mm^2) are left out and counted in `dropped`. */
std::vector<SectionPiece>
GroupPieces(std::vector<Polygon> contours, double minimumArea, int & dropped);

/** Whether two simple polygons overlap: they cross, or one lies in the other. */
bool
PolygonsOverlap(const Polygon & a, const Polygon & b);

/** \brief Drops what does not last: pieces and holes without an overlapping one on the slices before and after, and
 * bodies (chains of overlapping pieces) of fewer than `minimumSlices` slices or volumes below `minimumVolume` (mm^3).
 * Returns one line for each kind of thing dropped. A stack with a single slice that holds bone is left alone. */
std::vector<std::string>
DropShortLived(std::vector<Section> & sections, int minimumSlices, double minimumVolume);

/** Drops the inner contours (the member `inner` of each piece) in chains of overlapping ones on neighbouring slices
 * that last fewer than `minimumSlices` slices, or never reach `smallestArea` (mm^2). Returns the number of contours
 * dropped.
 */
int
DropShortLayers(std::vector<Section> & sections,
                std::vector<Polygon> SectionPiece::*inner,
                double                              smallestArea,
                int                                 minimumSlices);

/** The sections as contours: layers 0, 1, 2 with regions Cortical, Trabecular, Medullary; holes have layer 0 and region
 * Outside. Uses the stack's frame. */
ContourStack::SliceContainer
ToSlices(const std::vector<Section> & sections, const ContourStack & frame);
} // namespace bone

#endif
