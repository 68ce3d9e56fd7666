/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAngleRelaxation_h
#define boneAngleRelaxation_h

#include "bonePointStar.h"
#include "bonePointMover.h"

namespace bone
{
/** \class AngleRelaxation
 * \brief Moves points and flips edges of surfaces so that an \ref AngleMerit rises.
 *
 * Places for points are looked for at once for many that have no cell in common, and taken one after the other, so that
 * the result does not depend on the number of threads. Points and edges around which nothing has changed since they
 * were last looked at are left alone. What the mover refuses is not done. */
class AngleRelaxation
{
public:
  /** Between which flips keep the number of cells. */
  struct CellCount
  {
    IdType least;
    IdType most;
  };

  AngleRelaxation(TetraComplex &    complex,
                  PointMover &      mover,
                  AngleMerit &      merit,
                  CellCount         count,
                  const Execution & execution);

  /** All points and edges are looked at again: the merit has changed. */
  void
  Forget();

  /** The same for the points of some cells. */
  void
  Forget(const std::vector<IdType> & cells);

  /** Goes over all edges of surfaces and all points once; the number of flips and moves. */
  std::size_t
  Sweep();

private:
  /** Whether a point was not looked at yet, or has changed since. */
  bool
  IsNew(IdType p, const std::vector<std::uint32_t> & times) const;
  std::size_t
  FlipSurfaces();
  std::size_t
  MovePoints();
  bool
  FlipAt(IdType a, double mean);
  bool
  TryFlip(IdType a, IdType b, double mean);
  bool
  Take(IdType p, const PointStar::Move & move);
  /** The first points of `waiting`, in its order, no two of which have a cell in common; takes them out. */
  std::vector<IdType>
  TakeBatch(std::vector<IdType> & waiting);

  TetraComplex &             m_Complex;
  PointMover &               m_Mover;
  AngleMerit &               m_Merit;
  CellCount                  m_Count;
  Execution                  m_Execution;
  std::vector<std::uint32_t> m_Moved;   ///< by points, the complex' clock when a place was last looked for
  std::vector<std::uint32_t> m_Flipped; ///< the same, of flips of the edges there
};
} // namespace bone

#endif
