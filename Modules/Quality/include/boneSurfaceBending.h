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
/** Angle between the triangles (a, b, c) and (b, a, d), 0 where they are flat, rad. */
double
TurnAt(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d);

/** Mean angle between neighbouring triangles of the boundary but for flat cuts, rad: of the edges within a slice, where
 * slice meets slice, if points have slices; else of all. */
double
MeanBoundaryTurn(const TetraComplex & complex, const std::vector<int> & slices);

/** \class SurfaceBending
 * \brief The edges of a mesh's surfaces as hinges that resist turning.
 *
 * Energy of a hinge (mm^4): stiffness A^2 turn^2 / (1 + 8 turn / mean turn), A being the mean area of a surface point
 * and turn the angle (rad) between the two triangles: large turns count by themselves and not by their squares, so that
 * ridges stay. Next to it squared distances count times areas. Edges where surfaces meet, and those of flat cuts, are
 * none. A and the mean turn are those of the mesh when this was made. */
class SurfaceBending
{
public:
  /** \param stiffness  without unit, 0: no energy. */
  SurfaceBending(const TetraComplex & complex, double stiffness);

  /** Energy of an edge (a, b) between triangles with the corners c and d. */
  double
  Energy(const Vector3 & a, const Vector3 & b, const Vector3 & c, const Vector3 & d) const;

  /** Draws a place on a triangle to a target. */
  struct Spring
  {
    TriangleIds           points;
    std::array<double, 3> shares; ///< barycentric coordinates of the place
    double                weight; ///< mm^2
    Vector3               target;
  };

  /** \brief Where points go that springs draw and hinges hold to each other.
   *
   * Minimises the sum of weight |place - target|^2 and of the energies. To first order the turn is a linear function of
   * the four points of an edge (M. Bergou, M. Wardetzky, D. Harmon, D. Zorin, E. Grinspun, "A quadratic bending model
   * for inextensible surfaces", Symposium on Geometry Processing 2006): one linear system, in which the softening is
   * that of the turns as they are. A tenth of the weights holds points where they are, as springs alone need not say
   * where each point goes. Points that are not free, and those without springs, stay. */
  std::vector<Vector3>
  Solve(const std::vector<Vector3> & points,
        const std::vector<char> &    isFree,
        const std::vector<Spring> &  springs) const;

private:
  using Hinge = std::array<IdType, 4>; ///< the edge, then the opposite corners

  double
  Softening(double turn) const;

  std::vector<Hinge> m_Hinges;
  double             m_Factor{ 0.0 };   ///< stiffness A^2
  double             m_SoftTurn{ 1.0 }; ///< rad
};
} // namespace bone

#endif
