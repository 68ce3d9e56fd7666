/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceBending_h
#define boneSurfaceBending_h

#include "boneSurfaceGrid.h"
#include "boneTetraComplex.h"

#include <array>
#include <vector>

namespace bone
{
/** Dihedral deviation: angle between the normals of the triangles (a, b, c) and (b, a, d), 0 where they are coplanar,
 * rad. */
double
DihedralDeviation(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);

/** Mean dihedral deviation of the boundary's edges but for those of flat cuts, rad; if points have slices, of the edges
 * within a slice alone, where the strips between slices meet. */
double
MeanBoundaryDeviation(const TetraComplex & complex, const std::vector<int> & slices);

/** \class SurfaceBending
 * \brief Treats each edge between two triangles of a surface as a hinge that resists bending.
 *
 * The energy of a hinge (mm^4) is stiffness A^2 d^2 / (1 + 8 d / m). A is the mean area of a surface point, d the
 * dihedral deviation of the edge (rad) and m the mean dihedral deviation. The energy is quadratic for small d and
 * linear for large d, so that ridges are kept. It is to be compared with squared distances times areas. Edges where
 * surfaces meet and edges of flat cuts have no hinge. A and m are taken from the mesh when the object is constructed.
 */
class SurfaceBending
{
public:
  /** \param stiffness  without unit, 0: no energy. */
  SurfaceBending(const TetraComplex & complex, double stiffness);

  /** Energy of an edge (a, b) between triangles with the corners c and d. */
  double
  Energy(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d) const;

  /** A spring from a place on a triangle to a target. */
  struct Spring
  {
    TriangleIds           points;
    std::array<double, 3> shares; ///< barycentric coordinates of the place
    double                weight; ///< mm^2
    Vector3               target;
  };

  /** \brief The positions of the points that minimise the energy of springs and hinges.
   *
   * The energy is the sum of weight |place - target|^2 over the springs and of the hinges' energies. To first order the
   * dihedral deviation is a linear function of the four points of an edge (M. Bergou, M. Wardetzky, D. Harmon, D.
   * Zorin, E. Grinspun, "A quadratic bending model for inextensible surfaces", Symposium on Geometry Processing 2006),
   * so that one linear system is solved, with the softening of the present deviations. Springs alone need not determine
   * every point, so a tenth of their weights holds points where they are. Points that are not free, and points without
   * springs, stay. */
  std::vector<Vector3>
  Solve(const std::vector<Vector3> & points,
        const std::vector<char> &    isFree,
        const std::vector<Spring> &  springs) const;

private:
  using Hinge = std::array<IdType, 4>; ///< the edge, then the opposite corners

  double
  Softening(double deviation) const;

  std::vector<Hinge> m_Hinges;
  double             m_Factor{ 0.0 };        ///< stiffness A^2
  double             m_SoftDeviation{ 1.0 }; ///< rad
};
} // namespace bone

#endif
