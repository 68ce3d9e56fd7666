/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMedialAxis_h
#define boneMedialAxis_h

#include "boneContourStackParameters.h"
#include "bonePlaneField.h"

namespace bone
{
/** \brief A branch of an axis from one end or fork to the next, or around a hole back to where it starts; a single
 * point for a round section. */
struct AxisBranch
{
  std::vector<Vector2> points;
  std::vector<double>  clearance; ///< of each point: its distance to the nearest contour, mm
};

/** \brief Pruned medial axis of a region in the plane: the centres of the disks that touch its border at two or more
 * places.
 *
 * `contours[0]` is the closed, simple outer contour, the others its holes. The Voronoi diagram of their edges
 * (Boost.Polygon, on a grid of 0.1 micrometre; arcs between an edge and a corner become chords) is cut back from its
 * ends while the chord residual of R. Ogniewicz, O. Kuebler, doi:10.1016/0031-3203(94)00105-U, is insignificant, or the
 * clearance less than half the spacing. `parameters.spacing` must be above 0. Only ends are taken, so that the axis
 * stays connected and keeps exactly one cycle around each hole. Branches meet in common end points; each is sampled at
 * even distances, more finely where chords would leave the region or cross. Deterministic. \pre contours are simple,
 * disjoint, and the holes lie in the first. */
std::vector<AxisBranch>
ComputeMedialAxis(const std::vector<Polygon> & contours, const MedialAxisParameters & parameters);

/** For each of a slice's disjoint polygons the smallest one around it, -1: none. */
std::vector<int>
FindPolygonsAround(const std::vector<Polygon> & polygons);
} // namespace bone

#endif
