/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshRepair_h
#define boneMeshRepair_h

#include "bonePointOptimizer.h"

#include <functional>

namespace bone
{
/** \class MeshRepair
 * \brief Flips of surface edges and collapses of edges at the worst cells, where these get better by it.
 *
 * Every operation raises the smallest dihedral angle of the cells it touches. New triangles of boundary and interfaces
 * stay within `distanceBound` of the surfaces of the mesh as it was given (`first`), a point that goes within it of the
 * triangles that come, and the boundary does not pass through itself; the topology of body, regions, surfaces and
 * curves is kept. */
class MeshRepair
{
public:
  /** \param first  the surfaces as they were, not faired. */
  MeshRepair(TetraComplex & complex, PointMover & mover, const SurfaceTarget & first, double distanceBound);

  /** Goes once over all cells whose smallest dihedral angle has a cosine above `limit`, the worst first. `changed` is
   * called with the cells that came or changed. Returns the number of operations. */
  std::size_t
  Run(double limit, const std::function<void(const std::vector<IdType> &)> & changed);

  /** The collapse v -> w where it is legal and its new cells are better than `cosine`; the cells that changed. */
  bool
  TryCollapse(IdType v, IdType w, double cosine, std::vector<IdType> & changed);

  /** Cosine of the worst cell after the collapse v -> w, 2 where one would not be positive. */
  double
  WorstAfterCollapse(IdType v, IdType w) const;

private:
  bool
  FlipSurface(IdType t, std::vector<IdType> & changed);
  bool
  CollapseAt(IdType t, std::vector<IdType> & changed);
  bool
  IsNear(int surface, const std::array<Vector3, 3> & triangle) const;
  bool
  CollapseKeepsSurfaces(IdType v, IdType w, std::vector<TriangleIds> & removed, std::vector<TriangleIds> & added) const;

  TetraComplex &        m_Complex;
  PointMover &          m_Mover;
  const SurfaceTarget & m_First;
  double                m_SquaredBound;
};
} // namespace bone

#endif
