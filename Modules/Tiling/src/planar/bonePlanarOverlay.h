/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePlanarOverlay_h
#define bonePlanarOverlay_h

#include "boneExecution.h"
#include "boneTilingTypes.h"

#include <array>
#include <map>
#include <vector>

namespace bone
{
namespace tiling
{
/** A triangulation of a box: vertices 0 to 3 are its corners, counter-clockwise from the lowest; all others lie
 * strictly inside. Triangles are counter-clockwise. */
struct BoxTriangulation
{
  std::vector<Vector2>            points;
  std::vector<std::array<int, 3>> triangles;
};

/** \brief The common refinement of two triangulations of the same box.
 *
 * Each cell, the intersection of a triangle of the one with a triangle of the other, is convex; its corners are named
 * by what they are (a vertex, or a pair of crossing edges) and put in order by exact predicates alone, so that
 * neighbouring cells fit together whatever the rounding of the coordinates of crossings. */
struct PlanarOverlay
{
  struct Triangle
  {
    std::array<int, 3> vertices; ///< counter-clockwise
    int                first;    ///< triangle of the first triangulation that it lies in
    int                second;   ///< and of the second
  };
  /** Vertices of the first triangulation, then those of the second but its corners, then the crossings. */
  std::vector<Vector2>  points;
  std::vector<Triangle> triangles;
  /** Overlay vertex of each vertex of the first and of the second triangulation. */
  std::array<std::vector<int>, 2> vertexOf;
  /** Overlay vertices along each edge of the first and of the second triangulation, both ends with it, from the end of
   * the smaller vertex id. */
  std::array<std::map<Edge, std::vector<int>>, 2> chains;
};

/** Overlays two triangulations. Throws std::runtime_error where a vertex of one lies exactly on an edge or vertex of
 * the other (but for the corners), or a cell is too thin for its triangles to be positive in rounded coordinates: move
 * one of them by a little and try again. O(cells). */
PlanarOverlay
Overlay(const BoxTriangulation & first, const BoxTriangulation & second, const Execution & execution);
} // namespace tiling
} // namespace bone

#endif
