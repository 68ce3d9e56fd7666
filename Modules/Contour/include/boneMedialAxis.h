/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMedialAxis_h
#define boneMedialAxis_h

#include "bonePlaneField.h"

namespace bone
{
/** Parameters of \ref ComputeMedialAxis. */
struct MedialAxisParameters
{
  /** Distance between samples of the axis, mm. */
  double spacing{ 3.0 };
  /** A point of the axis counts where the contour between its two nearest points is longer than their straight distance
   * by more than this many times its clearance (a straight channel has infinity, the centre of a corner of 90 degrees
   * 0.59). */
  double significance{ 0.8 };
  /** An axis whose whole length is less than this many times its largest clearance is a point. */
  double roundness{ 1.0 };
};

/** A branch of an axis: points from one end to the other; a single point for a round section. */
using AxisBranch = std::vector<Vector2>;

/** \brief Pruned medial axis of a closed, simple polygon: the centres of the disks that touch it at two or more places.
 *
 * The Voronoi diagram of the polygon's edges (Boost.Polygon, on a grid of 0.1 micrometre) is cut down to its
 * significant part by the chord residual of R. Ogniewicz, O. Kuebler, doi:10.1016/0031-3203(94)00105-U, which leaves it
 * connected; ends that run into sharp corners are taken back to a clearance of half the spacing. Branches meet in
 * common end points; each is sampled at even distances. Every point lies inside the polygon. Deterministic. \pre the
 * polygon is simple. */
std::vector<AxisBranch>
ComputeMedialAxis(const Polygon & polygon, const MedialAxisParameters & parameters);
} // namespace bone

#endif
