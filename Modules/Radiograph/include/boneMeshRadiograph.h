/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshRadiograph_h
#define boneMeshRadiograph_h

#include "boneAttenuation.h"
#include "boneLoopRunner.h"
#include "boneMeshArrays.h"
#include "boneXRayGeometry.h"

#include <cstdint>
#include <limits>
#include <string>

namespace bone
{
/** What is integrated: scale * density + offset, in the tetrahedra of region minimumRegion..maximumRegion (all where
 * the mesh has no regions). */
struct MeshRadiographOptions
{
  int    minimumRegion{ std::numeric_limits<int>::min() };
  int    maximumRegion{ std::numeric_limits<int>::max() };
  double scale{ 1.0 };
  double offset{ 0.0 };
  bool   portable{ false }; ///< ProjectMesh: leave the processor's newer instructions alone

  friend bool
  operator==(const MeshRadiographOptions & a, const MeshRadiographOptions & b)
  {
    return a.minimumRegion == b.minimumRegion && a.maximumRegion == b.maximumRegion && a.scale == b.scale &&
           a.offset == b.offset && a.portable == b.portable;
  }
  friend bool
  operator!=(const MeshRadiographOptions & a, const MeshRadiographOptions & b)
  {
    return !(a == b);
  }
};

/** Why a radiograph cannot be made of this mesh, its density converted as said (None or WaterScaled), and what to do;
 * empty where it can. */
std::string
FindObstacle(const std::vector<Vector3> &  points,
             const MeshArrays &            cells,
             const MeshRadiographOptions & options,
             HUToAttenuation               conversion);

/** \defgroup MeshRadiograph Line integrals through a tetrahedral density model (paper 5)
 *
 * `points` are the mesh's points (mm) and `cells` all the rest (`cells.points` is not looked at); cells must hold a
 * density. `image` receives rows x columns line integrals, row by row, in density units times mm (both are
 * overwritten). Tetrahedra of either orientation count, flat ones do not; the mesh need not be convex, connected or
 * whole. The integral ends at the pixel; a source inside the mesh is allowed. The result does not depend on how `loops`
 * run.
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
            const MeshArrays &                      cells,
            const std::vector<XRayGeometry::View> & views,
            const MeshRadiographOptions &           options,
            const LoopRunner &                      loops,
            const std::vector<float *> &            images);

inline void
ProjectMesh(const std::vector<Vector3> &  points,
            const MeshArrays &            cells,
            const XRayGeometry::View &    view,
            const MeshRadiographOptions & options,
            const LoopRunner &            loops,
            float *                       image)
{
  ProjectMesh(points, cells, std::vector<XRayGeometry::View>{ view }, options, loops, std::vector<float *>{ image });
}

/** \brief Walks each ray from face neighbour to face neighbour, in double precision.
 *
 * A ray enters wherever it meets a boundary face from outside (again after leaving a non-convex bone), or starts in the
 * cell of the source. Needs `cells.neighbors`. `cellsPassed` (rows x columns, or null) receives the number of
 * tetrahedra met on each ray, of any region. */
void
WalkMesh(const std::vector<Vector3> &  points,
         const MeshArrays &            cells,
         const XRayGeometry::View &    view,
         const MeshRadiographOptions & options,
         const LoopRunner &            loops,
         float *                       image,
         std::int32_t *                cellsPassed);
/** \} */
} // namespace bone

#endif
