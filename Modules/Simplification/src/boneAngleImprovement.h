/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAngleImprovement_h
#define boneAngleImprovement_h

#include "boneExecution.h"
#include "boneSurfaceTarget.h"
#include "boneVolumeKeeper.h"

namespace bone
{
/** Smallest dihedral angles of cells by region, rad. */
struct AngleFloors
{
  double cortical{ 0.0 };
  double other{ 0.0 };

  double
  Of(int region) const
  {
    return region == Cortical ? cortical : other;
  }
  bool
  operator!=(const AngleFloors & floors) const
  {
    return cortical != floors.cortical || other != floors.other;
  }

  /** Cells with a smaller angle. */
  std::size_t
  CountBelow(const TetraComplex & complex) const;
};

/** What an \ref AngleImprovement is to reach, and to keep. */
struct AngleGoal
{
  AngleFloors floors;
  double      volumeChange{ 0.0 }; ///< largest share by which a region's volume may differ from the finest level's
  IdType      minimumCells{ 0 };   ///< edges are collapsed only where there are more
};

/** \class AngleImprovement
 * \brief Raises the smallest dihedral angles of a coarse level for finite elements.
 *
 * At cells below their floor edges of surfaces are flipped, edges collapsed, cells flipped and points moved: those of
 * surfaces and curves along the finest level's, others anywhere. First surfaces may hardly change, then more and more,
 * up to a quarter of the boundary's mean edge length from what they were. After each pass the regions get their volumes
 * back by a shift of surfaces; a pass after which a volume is farther from the finest level's than it may be is taken
 * back and is the last. A valid mesh stays valid, and its boundary does not come to pass through itself. */
class AngleImprovement
{
public:
  /** \param finest  the complex before the first collapse. */
  explicit AngleImprovement(const TetraComplex & finest);

  /** Returns whether anything has changed. */
  bool
  Run(TetraComplex & complex, const AngleGoal & goal, const Execution & execution) const;

private:
  SurfaceTarget m_Surfaces; ///< of the finest level
  VolumeKeeper  m_Volumes;
};
} // namespace bone

#endif
