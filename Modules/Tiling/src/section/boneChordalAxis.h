/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneChordalAxis_h
#define boneChordalAxis_h

#include "boneTilingTypes.h"

namespace bone
{
namespace tiling
{
/** Constrained Delaunay triangulation of a simple counter-clockwise polygon without further points; triples of
 * positions in `polygon`, counter-clockwise. Empty where the polygon crosses itself. */
std::vector<std::array<int, 3>>
TriangulatePolygon(const std::vector<Vector2> & polygon);

/** A tree in the plane. */
struct PlanarTree
{
  std::vector<Vector2>            points;
  std::vector<std::array<int, 2>> edges;
};

/** Chordal axis of a simple counter-clockwise polygon: the tree through the midpoints of the inner edges of its
 * constrained Delaunay triangulation. The ring between polygon and this tree can always be triangulated. */
PlanarTree
ChordalAxis(const std::vector<Vector2> & polygon);

/** Keeps of an axis the paths that reach more than 1 + `factor` clearances (distances to the polygon) beyond the rest,
 * beginning at the largest inscribed disk, cuts their ends back by `factor` clearances, straightens them and resamples
 * them to points about `spacing` apart; a single point for a round shape. */
PlanarTree
SimplifyAxis(const PlanarTree & axis, const std::vector<Vector2> & polygon, double factor, double spacing);

/** The tree of a walk around it; `plane` gives the places of the walk's vertices. */
PlanarTree
TreeOfWalk(const std::vector<Vector2> & plane, const Walk & walk);

/** A tree carried from one slice to the next, where the innermost loop is `polygon`: each point is drawn a part of the
 * way to the nearest point of `target`, and what comes to lie outside the polygon or close to it is cut off. May be
 * empty. */
PlanarTree
CarryAxis(const PlanarTree & tree, const PlanarTree & target, const std::vector<Vector2> & polygon, double leastEdge);

/** The closed walk around a tree, counter-clockwise; ids are those of `vertexOf` for the tree's points. */
Walk
TreeWalk(const PlanarTree & tree, const std::vector<int> & vertexOf);
} // namespace tiling
} // namespace bone

#endif
