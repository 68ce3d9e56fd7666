/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStackTopology_h
#define boneStackTopology_h

#include "boneContourStack.h"
#include "boneMeshArrays.h"

#include <ostream>

namespace bone
{
/** Betti numbers of a body. */
struct BodyTopology
{
  int components{ 0 };
  int handles{ 0 };
  int voids{ 0 };

  bool
  operator==(const BodyTopology & other) const
  {
    return components == other.components && handles == other.handles && voids == other.voids;
  }
};

std::ostream &
operator<<(std::ostream & os, const BodyTopology & topology);

/** The regions from `least` inward of a stack of contours, each slice thickened to the middle of its neighbours: two
 * slices are joined where they overlap, and nowhere else. Of the whole body (least = 1) voids are filled first, as the
 * tiling does. Decided on pixels of the given size (mm). */
BodyTopology
TopologyOfStack(const ContourStack & stack, int least, double pixel);

/** The regions from `least` inward of a mesh. */
BodyTopology
TopologyOfMesh(const MeshArrays & mesh, int least);

/** Euler characteristic of some tetrahedra of a mesh with their faces. */
long
EulerOfCells(const MeshArrays & mesh, const std::vector<std::size_t> & chosen);

/** Number of parts that tuples of points join; only points of tuples count. */
int
CountJoined(const std::vector<std::vector<IdType>> & joined, std::size_t points);
} // namespace bone

#endif
