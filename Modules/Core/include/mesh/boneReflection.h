/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneReflection_h
#define boneReflection_h

#include "boneMeshArrays.h"

namespace bone
{
/** \defgroup Reflection Left bones and right ones: reflection at the plane x = 0
 * \{ */
std::vector<Vector3>
ReflectPoints(std::vector<Vector3> points);

/** The mesh in the mirror: each tetrahedron's first two vertices change places, with its neighbours and coefficients, so
 * that it is positive again. Twice is the mesh itself. */
MeshArrays
ReflectMesh(MeshArrays mesh);
/** \} */
} // namespace bone

#endif
