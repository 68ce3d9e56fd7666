/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAngleGoal_h
#define boneAngleGoal_h

#include "boneTetraComplex.h"
#include "boneTypes.h"

#include <limits>

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
  std::vector<IdType>
  FindBelow(const TetraComplex & complex) const;
};

/** What an \ref AngleImprovement is to reach, and to keep. */
struct AngleGoal
{
  AngleFloors floors;              ///< what cells are to have
  AngleFloors least;               ///< no angle falls both below these and below the smallest around the point or edge
  double      volumeChange{ 0.0 }; ///< largest share by which a region's volume may differ from the finest level's
  IdType      minimumCells{ 0 };   ///< flips make no fewer
  IdType      maximumCells{ std::numeric_limits<IdType>::max() }; ///< nor more
};
} // namespace bone

#endif
