/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneOutwardMove_h
#define boneOutwardMove_h

#include "boneMeshArrays.h"

namespace bone
{
/** Moves of the points by which the outer surface moves outward by 1 mm. */
std::vector<Vector3>
OutwardMove(const MeshArrays & mesh);
} // namespace bone

#endif
