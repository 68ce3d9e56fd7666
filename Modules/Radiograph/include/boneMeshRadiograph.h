/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshRadiograph_h
#define boneMeshRadiograph_h

#include "boneDRRParameters.h"
#include "boneExecution.h"
#include "boneMeshArrays.h"
#include "boneXRayGeometry.h"

#include <cstdint>
#include <string>

namespace bone
{
/** What a radiograph of these regions integrates where HU are converted as said (None or WaterScaled). */
MeshRadiographParameters
MakeMeshRadiographParameters(int minimumRegion, int maximumRegion, HUToAttenuation conversion, double waterAttenuation);

/** Why a radiograph cannot be made of this mesh, its density converted as said (None or WaterScaled), and what to do;
 * empty where it can. */
std::string
FindObstacle(const std::vector<Vector3> &     points,
             const MeshCells &                cells,
             const MeshRadiographParameters & parameters,
             HUToAttenuation                  conversion);

/** \defgroup MeshRadiograph Line integrals through a tetrahedral density model (paper 5)
 *
 * `points` are the mesh's points (mm) and `cells` all the rest (`cells.points` is not looked at); cells must hold a
 * density. `image` receives rows x columns line integrals, row by row, in density units times mm (both are
 * overwritten). Tetrahedra of either orientation count, flat ones do not; the mesh need not be convex, connected or
 * whole. The integral ends at the pixel; a source inside the mesh is allowed. The result does not depend on the number
 * of threads.
 * \{ */

/** \brief Projects the tetrahedra onto the detector, in any order (Sadowsky, Cohen & Taylor, IEEE
 * Transactions on Visualization and Computer Graphics 12(4), 2006).
 *
 * Per tetrahedron and view: the depths of its four face planes, affine in the pixel; the density as a polynomial in
 * pixel offset and depth about the cell's centre. Per pixel: entry at the smallest front, exit at the largest back
 * depth, the polynomial's exact integral between them. Single precision inside with depths relative to the cell, double
 * for its geometry and for cells that are ill-conditioned seen from the source; cells that reach behind the source,
 * near it, or through the detector go through a general path. Uses AVX2 or AVX-512 where the processor has it. `images`
 * has one image for each of `views`; these share one loop, so that small views keep all threads busy. Error about 1e-6
 * of the image's largest value. For several calls with one mesh make a ProjectionModel. */
void
ProjectMesh(const std::vector<Vector3> &            points,
            const MeshCells &                       cells,
            const std::vector<XRayGeometry::View> & views,
            const MeshRadiographParameters &        parameters,
            const Execution &                       execution,
            const std::vector<float *> &            images);

inline void
ProjectMesh(const std::vector<Vector3> &     points,
            const MeshCells &                cells,
            const XRayGeometry::View &       view,
            const MeshRadiographParameters & parameters,
            const Execution &                execution,
            float *                          image)
{
  ProjectMesh(
    points, cells, std::vector<XRayGeometry::View>{ view }, parameters, execution, std::vector<float *>{ image });
}
/** \} */
} // namespace bone

#endif
