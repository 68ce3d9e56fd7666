/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDirectedSurface_h
#define boneDirectedSurface_h

#include "boneTriangleSurface.h"
#include "boneTriangleTree.h"

#include <vector>

namespace bone
{
/** \class DirectedSurface
 * \brief Nearest points of a surface among those whose normal looks the way that is asked for.
 *
 * Triangles are sorted into trees by 14 directions (faces and corners of a cube), each with those within 75 degrees of
 * it; a query takes the tree of the direction nearest to its normal, so that matches differ by less than 48 degrees at
 * will and never by more than 103: the two faces of a thin plate are not mixed up. Const use is safe from many threads.
 */
class DirectedSurface
{
public:
  explicit DirectedSurface(const TriangleSurface & surface);

  struct Match
  {
    Vector3 point{ Vector3::Zero() };
    double  squaredDistance{ 0.0 };
    int     triangle{ -1 }; ///< -1: there is none
  };

  /** The nearest point whose normal suits `normal`. */
  Match
  Find(const Vector3 & x, const Vector3 & normal) const;

  /** The nearest point of all. */
  Match
  FindAny(const Vector3 & x) const;

  const TriangleSurface &
  GetSurface() const
  {
    return m_Surface;
  }
  const std::vector<Vector3> &
  GetPointNormals() const
  {
    return m_PointNormals;
  }
  /** Weights of a triangle's three points at a place on it. */
  Vector3
  Weights(int triangle, const Vector3 & x) const;
  /** Unit normal at a place on a triangle, from those of its points. */
  Vector3
  NormalAt(int triangle, const Vector3 & x) const;

private:
  struct Bucket
  {
    Vector3          direction;
    TriangleTree     tree;
    std::vector<int> triangle; // of the surface
  };

  TriangleSurface      m_Surface;
  std::vector<Vector3> m_PointNormals;
  TriangleTree         m_All;
  std::vector<Bucket>  m_Buckets;
};
} // namespace bone

#endif
