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
 * Every operation but those of CollapseShort raises the smallest dihedral angle of the cells it touches. Boundary and
 * interfaces stay within the mover's bound, and the boundary does not pass through itself; the topology of body,
 * regions, surfaces and curves is kept. */
class MeshRepair
{
public:
  /** \param distanceBound  mm, of points that a curve loses; surfaces have the mover's. */
  MeshRepair(TetraComplex & complex, PointMover & mover, double distanceBound);

  /** Goes once over all cells whose smallest dihedral angle has a cosine above `limit`, the worst first, but for those
   * that an earlier call could do nothing for and at whose points nothing has changed since. `changed` is called with
   * the cells that came or changed. Returns the number of operations. */
  std::size_t
  Run(double limit, const std::function<void(const std::vector<IdType> &)> & changed);

  /** Cells that nothing could be done for are tried again: to be called where the mover's bound has changed. */
  void
  Forget()
  {
    m_Refused.clear();
  }

  /** Collapses edges shorter than `length` (mm) whatever cells that leaves, as long as they are positive, the shortest
   * first, until no more can be: knots of nearly coincident points, where no single collapse raises the smallest angle.
   * Returns the number of collapses. */
  std::size_t
  CollapseShort(double length);

  /** The collapse v -> w where it is legal and its new cells are better than `cosine`; the cells that changed. */
  bool
  TryCollapse(IdType v, IdType w, double cosine, std::vector<IdType> & changed);

  /** Cosine of the worst cell after the collapse v -> w, 2 where one would not be positive; any value from `enough` on
   * where it is that large. */
  double
  WorstAfterCollapse(IdType v, IdType w, double enough = 2.0) const;

private:
  bool
  IsRefused(IdType t) const;
  bool
  FlipSurface(IdType t, std::vector<IdType> & changed);
  bool
  CollapseAt(IdType t, std::vector<IdType> & changed);
  bool
  CollapseKeepsSurfaces(IdType v, IdType w);
  bool
  CollapseShortEdge(IdType v, IdType w);

  TetraComplex & m_Complex;
  PointMover &   m_Mover;
  double         m_SquaredBound;
  /** By slots of cells: the complex' clock when nothing could be done, 0 for never. */
  std::vector<std::uint32_t> m_Refused;
};
} // namespace bone

#endif
