/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAngleImprovement_h
#define boneAngleImprovement_h

#include "boneAngleGoal.h"
#include "boneExecution.h"
#include "boneRegionVolumes.h"
#include "boneSurfaceTarget.h"

namespace bone
{
/** \class AngleImprovement
 * \brief Gives a coarse level the dihedral angles that finite elements need.
 *
 * An \ref AngleRelaxation in two steps: in the first surfaces weigh little and cells get their shape, in the second
 * they weigh more and come back. In each, the weight of cells below their floor is doubled until none is left. After
 * each sweep cells are flipped where an angle is below 25 degrees.
 *
 * No angle falls below the least that are allowed and what was there. Surfaces stay within a quarter of the boundary's
 * mean edge length of what they were, both ways; a run that takes a region's volume beyond its bound, and farther than
 * it was, is taken back. A valid mesh stays valid, and its boundary does not come to pass through itself. The result
 * does not depend on the number of threads.
 *
 * Edges are not collapsed: at bad cells a collapse takes points of the surface that no move brings back. */
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
  RegionVolumes m_Volumes;
};
} // namespace bone

#endif
