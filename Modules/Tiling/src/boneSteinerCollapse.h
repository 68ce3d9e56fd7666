/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSteinerCollapse_h
#define boneSteinerCollapse_h

#include "boneMeshArrays.h"

namespace bone
{
namespace tiling
{
/** Collapses the points from `firstSteiner` on onto their neighbours, shortest edges first, as long as every
 * tetrahedron stays positive (exact) and the topology of all regions and of the surfaces between them stays. Regions
 * are those of the mesh, 0 meaning outside of the bone, of whose cells no more is asked. Returns the cells left; points
 * keep their ids. Deterministic. */
MeshArrays
CollapseSteinerPoints(const MeshArrays & mesh, IdType firstSteiner);
} // namespace tiling
} // namespace bone

#endif
