/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTriangleDistance_h
#define boneTriangleDistance_h

#include "boneTriangleTree.h"

#include <vector>

namespace bone
{
/** \class TriangleDistance
 * \brief Exact signed distance to a closed triangle surface.
 *
 * The sign is that of the angle-weighted pseudonormal of the nearest face, edge or vertex (J. A. Baerentzen and
 * H. Aanaes, doi:10.1109/TVCG.2005.49). Const use is safe from many threads. */
class TriangleDistance
{
public:
  using Triangle = std::array<IdType, 3>;

  /** A surface that looks inward is turned. Throws itk::ExceptionObject where there are fewer than four triangles, a
   * point is not finite, an id is out of range, a triangle is flat, or the surface is not closed and oriented (each
   * edge in two triangles, in opposite directions). */
  TriangleDistance(const std::vector<Vector3> & points, std::vector<Triangle> triangles);

  struct Nearest
  {
    double  distance; ///< mm, negative inside
    Vector3 point;    ///< on the surface
    Vector3 gradient; ///< unit vector of increasing distance
    int     triangle; ///< that the point is on
  };
  Nearest
  FindNearest(const Vector3 & x) const;

  /** Whether the surface lies within a distance (mm) of x: quicker than to find the nearest point. */
  bool
  IsWithin(const Vector3 & x, double distance) const
  {
    return m_Tree.IsWithin(x, distance * distance);
  }

  const std::vector<Vector3> &
  GetPoints() const
  {
    return m_Points;
  }
  const std::vector<Triangle> &
  GetTriangles() const
  {
    return m_Triangles;
  }
  /** Volume enclosed, mm^3. */
  double
  GetVolume() const
  {
    return m_Volume;
  }

private:
  void
  Verify() const;
  void
  Orient();
  /** Requires a valid surface. */
  void
  ComputeNormals();

  std::vector<Vector3>                m_Points;
  std::vector<Triangle>               m_Triangles;
  std::vector<Vector3>                m_FaceNormals;
  std::vector<std::array<Vector3, 3>> m_EdgeNormals; ///< of edge i, from vertex i to the next
  std::vector<Vector3>                m_PointNormals;
  double                              m_Volume{ 0.0 };
  TriangleTree                        m_Tree;
};
} // namespace bone

#endif
