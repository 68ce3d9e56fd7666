/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildLevels_h
#define boneBuildLevels_h

#include "boneExecution.h"
#include "boneMeshArrays.h"
#include "boneTetraCollapseParameters.h"
#include "boneTetraComplex.h"

#include <array>
#include <string>
#include <vector>

namespace bone
{
/** One level as made. */
struct BuiltLevel
{
  MeshArrays                                  mesh;
  std::vector<IdType>                         parentPoint;               ///< id of each point in the level before
  double                                      densityErrorBound{ -1.0 }; ///< negative: none
  double                                      densityError{ 0.0 };
  double                                      cellError{ 0.0 }; ///< largest of a changed cell, where bounds hold it
  double                                      surfaceError{ 0.0 };
  std::string                                 stopReason;
  std::size_t                                 collapses{ 0 };
  std::array<std::size_t, MeshOperationCount> refused{}; ///< candidates refused while this level was made
};

/** The levels after the first, which is the mesh itself. The work of TetraCollapseFilter on plain arrays.
 * \pre ValidateMesh finds nothing wrong with the mesh; the parameters hold a number or a bound. */
std::vector<BuiltLevel>
BuildLevels(MeshArrays mesh, const TetraCollapseParameters & parameters, const Execution & execution);
} // namespace bone

#endif
