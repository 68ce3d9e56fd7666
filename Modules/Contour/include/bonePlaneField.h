/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePlaneField_h
#define bonePlaneField_h

#include "boneTypes.h"

#include <vector>

namespace bone
{
/** A closed polygon in a plane (mm), first point not repeated. */
using Polygon = std::vector<Vector2>;

/** \brief Regular grid in a plane, whose axes are the plane's coordinate axes: node (i, j) lies at origin + (i *
 * spacing x, j * spacing y), mm. */
struct PlaneGrid
{
  std::array<int, 2> size{ { 0, 0 } };
  Vector2            origin{ Vector2::Zero() };
  Vector2            spacing{ Vector2::Ones() };

  std::size_t
  Count() const
  {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  }
  std::size_t
  Offset(int i, int j) const
  {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(size[0]) + static_cast<std::size_t>(i);
  }
  Vector2
  Node(int i, int j) const
  {
    return { origin.x() + i * spacing.x(), origin.y() + j * spacing.y() };
  }
};

/** The grid of the given spacing that covers `polygons` and a margin (mm) around them, with nodes at whole multiples of
 * the spacing from `anchor`. Empty for no points. */
PlaneGrid
CoveringGrid(const std::vector<Polygon> & polygons, double margin, const Vector2 & anchor, const Vector2 & spacing);

/** \brief A scalar at each node of a grid, between them bilinear. */
struct PlaneField
{
  PlaneGrid          grid;
  std::vector<float> values;

  /** Bilinear value; outside the grid that of the nearest point of its border. \pre the grid is not empty. */
  double
  Sample(const Vector2 & q) const;

  /** Value by the cubic convolution of Keys (a = -1/2) where the whole stencil lies in the grid, else bilinear. */
  double
  SampleCubic(const Vector2 & q) const;
};

/** Closed contours where the field passes `level` (marching squares; a saddle is decided by the cell's mean). Higher
 * values lie to the left: outer contours are counter-clockwise, holes clockwise. A region that reaches the border is
 * closed half a node beyond it. Contours are simple and disjoint, in a fixed order. W. Lorensen, H. Cline,
 * doi:10.1145/37401.37422, in two dimensions. */
std::vector<Polygon>
ExtractLevelContours(const PlaneField & field, double level);

/** Smooths with a Gaussian of the given standard deviation (mm), borders replicated. */
void
SmoothField(PlaneField & field, double sigma);

/** \brief For each node of a grid the nearest point of a set of polygons and the signed distance to it. */
struct DistanceField
{
  PlaneField         distance; ///< mm, positive inside (even-odd rule)
  std::vector<int>   polygon;  ///< nearest polygon; -1 where there is none
  std::vector<int>   edge;     ///< nearest edge of it
  std::vector<float> along;    ///< position on that edge, 0..1
};

/** Distance by vector propagation from the polygons (P.-E. Danielsson, doi:10.1016/0146-664X(80)90054-4, with exact
 * distances to edges); exact next to the polygons, elsewhere to a small fraction of the spacing. Nodes further away
 * than about `limit` (mm) get plus or minus 1e9 and no nearest polygon. */
DistanceField
ComputeDistanceField(const std::vector<Polygon> & polygons, const PlaneGrid & grid, double limit = 1e9);
} // namespace bone

#endif
