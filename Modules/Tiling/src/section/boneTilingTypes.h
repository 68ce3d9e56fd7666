/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTilingTypes_h
#define boneTilingTypes_h

#include "boneTypes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace bone
{
namespace tiling
{
constexpr double Infinity = std::numeric_limits<double>::infinity();

/** An edge by the ids of its ends. */
using Edge = std::array<int, 2>;

/** The edge with its ends in ascending order. */
inline Edge
Undirected(int a, int b)
{
  return { { std::min(a, b), std::max(a, b) } };
}

/** All vertices of the mesh under construction: in-plane coordinates and place in space. */
struct VertexPool
{
  std::vector<Vector2> plane;
  std::vector<Vector3> space;
  std::vector<int>     layer;
  std::vector<int>     slice;

  int
  Add(const Vector2 & q, const Vector3 & p, int layerOfPoint, int sliceOfPoint)
  {
    plane.push_back(q);
    space.push_back(p);
    layer.push_back(layerOfPoint);
    slice.push_back(sliceOfPoint);
    return static_cast<int>(plane.size()) - 1;
  }

  /** Drops the vertices added last. */
  void
  Resize(std::size_t size)
  {
    plane.resize(size);
    space.resize(size);
    layer.resize(size);
    slice.resize(size);
  }
};

/** A closed walk: vertex ids in cyclic order, material on the left. Around a tree (medial axis, bridge) each edge is
 * walked twice, once on each side; a single vertex is a walk of length 1 without steps. */
using Walk = std::vector<int>;

/** Number of steps of a closed walk. */
inline int
WalkSteps(const Walk & walk)
{
  return walk.size() > 1 ? static_cast<int>(walk.size()) : 0;
}

/** A cyclic order of single steps of two walks: letter 0 advances the first, letter 1 the second. It begins at
 * positions (first, second) and ends there after all steps of both. The triangulation of a ring on its slice is one
 * (first: outer walk, second: inner walk); so is the wall between two slices (first: lower, second: upper). */
struct Merge
{
  int                       first{ 0 };
  int                       second{ 0 };
  std::vector<std::uint8_t> letters;
};

/** A detour of a ring's inner walk: a bridge to another piece and the walk round that piece's innermost contour or
 * axis, left and come back to at `position` of the walk of the layer inside, which does not take part in it. */
struct Spur
{
  int position;
  int length; ///< steps
};

/** Slot of the inner half of a piece round a hole: it lies between a loop halfway to the hole and the hole. Slots of
 * other rings are their regions. */
constexpr int InnerHalf = 1000;

/** The region that a ring's slot stands for. */
inline int
RegionOfSlot(int slot)
{
  return slot % InnerHalf;
}

/** A triangle of a section, counter-clockwise. */
struct PlanarTriangle
{
  std::array<int, 3> vertices;
  int                region;
};

/** The planar structure of one piece of bone on a slice, or of several joined by bridges (the paper's composite
 * contour): nested walks from the outer contour to the innermost walk (medial axis or hole) and the triangulated rings
 * between them. */
struct Section
{
  /** Slot of each ring, outside in: its region, or that plus InnerHalf. */
  std::vector<int> region;
  /** walks[k] bounds ring k outside; the last one is the innermost. One more than rings. */
  std::vector<Walk> walks;
  /** Inner bounds of the rings: inner[k] is walks[k + 1] with the detours spurs[k] (ascending by position). */
  std::vector<Walk>              inner;
  std::vector<std::vector<Spur>> spurs;
  /** rings[k] lies between walks[k] and inner[k]. */
  std::vector<Merge> rings;
  /** Number of layers it has itself; deeper rings are without extent. */
  int depth{ 0 };
  /** The innermost walk goes round a hole and not round a tree. */
  bool hole{ false };
  /** Index of the slice, for reports. */
  int slice{ 0 };
  /** Contours of the holes in it, counter-clockwise; not of composites. */
  std::vector<Walk> holes;
  /** Triangles of a piece that has no rings; its only walk is the outer contour. */
  std::vector<PlanarTriangle> patch;
};

/** The wall of a ring's inner walks from the wall of the walks of the layer inside: each detour is walked where the
 * other side is nearest to it. */
Merge
WithSpurs(const std::vector<Vector2> & plane,
          const Section &              lower,
          const Section &              upper,
          int                          ring,
          const Merge &                wall);

/** All triangles of a section, with their regions. */
std::vector<PlanarTriangle>
SectionTriangles(const Section & section);
} // namespace tiling
} // namespace bone

#endif
