/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeanDensities_h
#define boneMeanDensities_h

#include "boneMeshArrays.h"

namespace bone
{
/** The mesh with the mean of each tetrahedron as its density: all that small images show of a coarse level. */
MeshArrays
WithMeanDensities(const MeshArrays & mesh);
} // namespace bone

#endif
