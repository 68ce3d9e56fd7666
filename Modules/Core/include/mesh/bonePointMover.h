/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePointMover_h
#define bonePointMover_h

#include "boneExecution.h"
#include "boneSurfaceBound.h"
#include "boneSurfaceGrid.h"

#include <vector>

namespace bone
{
/** \class PointMover
 * \brief Moves single points of a valid mesh so that it stays valid.
 *
 * A move is refused where a tetrahedron at the point would not be positive (exact), where the smallest dihedral angle
 * at the point would fall both below a floor and below what it was, where the boundary would pass through itself, and
 * where boundary or interfaces would leave their bound, if there is one. */
class PointMover
{
public:
  /** \param bound  of the surfaces; none: they may go anywhere.
   * \param execution  its abort is noticed at each move: what moves points throws itk::ProcessAborted then. */
  explicit PointMover(TetraComplex & complex, SurfaceBound * bound = nullptr, const Execution & execution = {});

  /** \param cosineFloor  cosine of the smallest dihedral angle wanted; 1: no floor. */
  MeshOperation
  TryMove(IdType p, const Vector3 & x, double cosineFloor);

  /** Whether surface triangles may be replaced by others without the boundary passing through itself or surfaces
   * leaving their bound; where they may, this counts them as replaced. */
  bool
  ReplaceSurface(const std::vector<SurfaceTriangle> & removed, const std::vector<SurfaceTriangle> & added);

  /** Cosine of the smallest dihedral angle around p. */
  double
  WorstCosine(IdType p) const;

private:
  bool
  StarIsPositive(IdType p) const;
  /** Whether an angle around p is smaller than the floor's and than all were with p where it was before. */
  bool
  FallsBelow(IdType p, const Vector3 & before, double cosineFloor);
  void
  CollectSurface(IdType p);
  bool
  BoundaryCrosses(IdType p) const;

  TetraComplex &                         m_Complex;
  SurfaceBound *                         m_Bound;
  Execution                              m_Execution;
  SurfaceGrid                            m_Grid;
  std::vector<TriangleIds>               m_Boundary;  ///< boundary triangles at the point that is moved
  std::vector<SurfaceTriangle>           m_Triangles; ///< of all surfaces there
  std::vector<TetraComplex::SurfaceFace> m_Faces;
};
} // namespace bone

#endif
