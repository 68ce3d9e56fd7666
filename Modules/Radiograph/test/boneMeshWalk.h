/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshWalk_h
#define boneMeshWalk_h

#include "boneMeshRadiograph.h"

namespace bone
{
/** \brief What the projection is compared with: each ray from face neighbour to face neighbour (paper 5), slowly, in
 * double precision.
 *
 * A ray enters wherever it meets a boundary face from outside (again after leaving a non-convex bone), or starts in the
 * cell of the source. Needs `cells.neighbors`. `cellsPassed` (rows x columns, or null) receives the number of
 * tetrahedra met on each ray, of any region. */
void
WalkMesh(const std::vector<Vector3> &     points,
         const MeshCells &                cells,
         const XRayGeometry::View &       view,
         const MeshRadiographParameters & parameters,
         const Execution &                execution,
         float *                          image,
         std::int32_t *                   cellsPassed);
} // namespace bone

#endif
