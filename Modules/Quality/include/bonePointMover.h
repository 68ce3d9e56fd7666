/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePointMover_h
#define bonePointMover_h

#include "boneSurfaceGrid.h"
#include "boneTetraComplex.h"

#include <vector>

namespace bone
{
/** \class PointMover
 * \brief Moves single points of a valid mesh so that it stays valid.
 *
 * A move is refused where a tetrahedron at the point would not be positive (exact), where the smallest dihedral angle
 * at the point would fall both below a floor and below what it was, and where the boundary would pass through itself.
 */
class PointMover
{
public:
  explicit PointMover(TetraComplex & complex);

  /** \param cosineFloor  cosine of the smallest dihedral angle wanted; 1: no floor. */
  MeshOperation
  TryMove(IdType p, const Vector3 & x, double cosineFloor);

  /** Whether boundary triangles may be replaced by others without the boundary passing through itself; where they may,
   * this counts them as replaced. Triangles are counted where their surface is tested (\ref IsTested). */
  bool
  ReplaceBoundary(const std::vector<TriangleIds> & removed, const std::vector<TriangleIds> & added);

  /** Whether triangles of a surface are tested against each other: those of the boundary, but for flat cuts. */
  bool
  IsTested(int surface) const;

  /** Cosine of the smallest dihedral angle around p. */
  double
  WorstCosine(IdType p) const;

private:
  bool
  StarIsPositive(IdType p) const;
  void
  CollectBoundary(IdType p);
  bool
  BoundaryCrosses(IdType p) const;

  TetraComplex &                         m_Complex;
  SurfaceGrid                            m_Grid;
  std::vector<TriangleIds>               m_Boundary; ///< boundary triangles at the point that is moved
  std::vector<TetraComplex::SurfaceFace> m_Faces;
};
} // namespace bone

#endif
