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
 * Every operation raises the smallest dihedral angle of the cells it touches. Boundary and interfaces stay within the
 * mover's bound, and the boundary does not pass through itself; the topology of body, regions, surfaces and curves is
 * kept. */
class MeshRepair
{
public:
  /** \param distanceBound  mm, of points that a curve loses; surfaces have the mover's. */
  MeshRepair(TetraComplex & complex, PointMover & mover, double distanceBound);

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
  CollapseKeepsSurfaces(IdType v, IdType w);

  TetraComplex & m_Complex;
  PointMover &   m_Mover;
  double         m_SquaredBound;
};
} // namespace bone

#endif
