/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneConstrainedTriangulation_h
#define boneConstrainedTriangulation_h

#include "boneTypes.h"

#include <array>
#include <vector>

namespace bone
{
namespace tiling
{
/** \brief Constrained Delaunay triangulation of points and segments in a box.
 *
 * Points are inserted one by one with Lawson's flips, segments by flipping the edges that cross them (S. W. Sloan,
 * doi:10.1016/0045-7949(93)90239-A). All decisions are made by exact predicates. Vertices 0 to 3 are the corners of
 * the box, counter-clockwise from the lowest. */
class ConstrainedTriangulation
{
public:
  struct Triangle
  {
    std::array<int, 3>  vertices;                               ///< counter-clockwise
    std::array<int, 3>  neighbors{ { -1, -1, -1 } };            ///< across the edge opposite each vertex, -1 at the box
    std::array<bool, 3> constrained{ { false, false, false } }; ///< the edge opposite each vertex
  };

  ConstrainedTriangulation(const Vector2 & lowest, const Vector2 & highest);

  /** Inserts a point strictly inside the box and returns its vertex; that of an equal point if there is one. */
  int
  Insert(const Vector2 & q);

  /** Makes the segment between two vertices an edge, or several where it runs through vertices. Segments must not
   * cross each other: throws std::runtime_error where they do. */
  void
  Constrain(int a, int b);

  const std::vector<Vector2> &
  GetPoints() const
  {
    return m_Points;
  }
  const std::vector<Triangle> &
  GetTriangles() const
  {
    return m_Triangles;
  }

  /** For each triangle, whether an odd number of constrained edges lies between it and the box. */
  std::vector<char>
  Inside() const;

private:
  int
  IndexOf(int t, int vertex) const;
  void
  Link(int t, int i, int neighbor, int old);
  void
  SplitTriangle(int t, int v);
  void
  SplitEdge(int t, int i, int v);
  bool
  Flippable(int t, int i) const;
  void
  Flip(int t, int i);
  void
  Legalize(std::vector<std::array<int, 2>> & edges);
  std::array<int, 2>
  FindEdge(int a, int b) const;
  void
  MarkConstrained(int a, int b);

  std::vector<Vector2>  m_Points;
  std::vector<Triangle> m_Triangles;
  std::vector<int>      m_TriangleOf; ///< a triangle of each vertex
  int                   m_Last{ 0 };  ///< where the search for the next point starts
};
} // namespace tiling
} // namespace bone

#endif
