/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeanDensities_h
#define boneMeanDensities_h

#include "boneBuildLevels.h"

namespace bone
{
/** The mesh with the mean of each tetrahedron as its density: all that small images show of a coarse level. */
MeshArrays
WithMeanDensities(const MeshArrays & mesh);

/** How many tetrahedra a search on small images takes. */
constexpr std::size_t SearchTetrahedra = 1000;

/** The same, simplified to about so many tetrahedra where it has more and is valid. `parentPoint` tells the mesh's
 * point of each. */
BuiltLevel
SimplifyMeans(const MeshArrays & mesh, std::size_t tetrahedra, const Execution & execution);
} // namespace bone

#endif
