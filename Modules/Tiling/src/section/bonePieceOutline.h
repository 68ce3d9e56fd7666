/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePieceOutline_h
#define bonePieceOutline_h

#include "boneContourStack.h"
#include "boneTilingReport.h"

#include <set>

namespace bone
{
namespace tiling
{
/** One piece of bone on a slice before it is triangulated: nested polygons in the plane, all counter-clockwise. */
struct PieceOutline
{
  struct Loop
  {
    std::vector<Vector2> points;
    int                  layer{ 0 };
    int                  region{ 1 }; ///< just inside; Region::Outside of a hole
    int                  id{ 0 };
    int                  parent{ -1 }; ///< position of the smallest loop around it
  };
  /** The outer contour, then what lies in it, each after its parent. */
  std::vector<Loop> loops;
  /** A polyline of the medial axis of an innermost loop as given. */
  struct Axis
  {
    std::vector<Vector2> points;
    int                  layer{ 1 };
  };
  std::vector<Axis> axes;

  /** Whether the loops are nested in each other, region by region inward, with a hole in none but the outer contour of
   * a piece without layers: what can be divided into rings. */
  bool
  IsChain() const;
};

/** Sorts the contours of a slice into nested pieces. The holes with ids in `closed`, and a contour that lies in what it
 * bounds itself, are left out and counted in the report. */
std::vector<PieceOutline>
CollectPieces(const ContourStack & stack, std::size_t slice, const std::set<int> & closed, TilingReport & report);

/** Splits edges that are long against the distance to the next loop inward or outward. Returns the number of points
 * added. */
int
RefineThinLayers(PieceOutline & piece);

/** "slice 12, contour 3: " */
std::string
PlaceOf(std::size_t slice, int contour);
} // namespace tiling
} // namespace bone

#endif
