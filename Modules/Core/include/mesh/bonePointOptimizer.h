/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePointOptimizer_h
#define bonePointOptimizer_h

#include "bonePointMover.h"
#include "boneSurfaceTarget.h"
#include "boneTetraFlips.h"

#include <vector>

namespace bone
{
/** Living cells whose smallest dihedral angle has a cosine above the limit, the worst first; each after the negative
 * of that cosine. */
std::vector<std::pair<double, IdType>>
FindWorstCells(const TetraComplex & complex, double limit);

/** Unit vectors along the axes and the diagonals of a cube: the steps of a pattern search in space. */
const std::vector<Vector3> &
SearchDirections();

/** \class PointOptimizer
 * \brief Moves the points of the worst cells so that the smallest dihedral angle around each rises.
 *
 * A pattern search: steps along axes and diagonals, shrinking from stage to stage; surface points move on their target.
 * A point where nothing has changed since it was last looked at is left alone. */
class PointOptimizer
{
public:
  PointOptimizer(TetraComplex & complex, PointMover & mover, const SurfaceTarget & target);

  /** Moves the points of all cells whose smallest dihedral angle has a cosine above `limit`, points of surfaces where
   * it is above `surfaceLimit`; the worst first, each once. Returns the number of moves. */
  std::size_t
  Run(double limit, double surfaceLimit);

  /** Moves one point; whether it got better. */
  bool
  Improve(IdType p);

  void
  MarkAll();
  /** Marks the points of cells that were replaced. */
  void
  Mark(const std::vector<IdType> & cells);

private:
  double
  WorstAt(IdType p, const Vector3 & x, double limit);

  TetraComplex &        m_Complex;
  PointMover &          m_Mover;
  const SurfaceTarget & m_Target;
  std::vector<Vector3>  m_Better; ///< places that were found for a point, each better than the one before
  std::vector<char>     m_Dirty;  ///< something at the point has changed since it was last looked at
};
} // namespace bone

#endif
