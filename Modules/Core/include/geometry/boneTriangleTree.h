/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTriangleTree_h
#define boneTriangleTree_h

#include "boneTypes.h"

#include <vector>

namespace bone
{
/** Point of the triangle a, b, c nearest to x. C. Ericson, "Real-Time Collision Detection", 5.1.5. */
Vector3
ClosestPointOnTriangle(const Vector3 & x, const Vector3 & a, const Vector3 & b, const Vector3 & c);

/** Point of the segment a, b nearest to x. */
Vector3
ClosestPointOnSegment(const Vector3 & x, const Vector3 & a, const Vector3 & b);

/** \class TriangleTree
 * \brief Nearest points on a set of triangles: a tree of bounding boxes. Segments are triangles with b = c.
 *
 * Building is O(n log n), a query O(log n) near the surface. Const use is safe from many threads. */
class TriangleTree
{
public:
  using Triangle = std::array<Vector3, 3>;

  TriangleTree() = default;
  explicit TriangleTree(std::vector<Triangle> triangles);

  bool
  IsEmpty() const
  {
    return m_Triangles.empty();
  }

  struct Nearest
  {
    Vector3 point{ Vector3::Zero() };
    double  squaredDistance{ 0.0 };
    int     triangle{ -1 }; ///< -1: the tree is empty
  };

  /** The nearest point; of equally near triangles the one found first in a fixed order. */
  Nearest
  FindNearest(const Vector3 & x) const;

  /** The squared distance of the nearest point, and its triangle, both as FindNearest has them; quicker where
   * `triangle` is near x already, as that of the point before. */
  double
  FindSquaredDistance(const Vector3 & x, int & triangle) const;

  /** Whether a triangle lies within a distance, given squared, of x: quicker than to find the nearest. */
  bool
  IsWithin(const Vector3 & x, double squaredDistance) const;

  const Triangle &
  GetTriangle(int index) const
  {
    return m_Triangles[m_Place[index]];
  }

private:
  struct Node
  {
    Vector3 lower;
    Vector3 upper;
    int     begin;
    int     end;
    int     right; // the left child follows its parent; -1: a leaf
  };

  int
  Build(int begin, int end);

  /** The nearest point, where it is nearer than that of `nearest`. */
  void
  FindNearer(const Vector3 & x, Nearest & nearest) const;

  std::vector<Triangle> m_Triangles; ///< leaf by leaf
  std::vector<int>      m_Order;     ///< their numbers as they were given
  std::vector<int>      m_Place;     ///< of each number
  std::vector<Node>     m_Nodes;
};
} // namespace bone

#endif
