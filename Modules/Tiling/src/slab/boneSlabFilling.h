/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSlabFilling_h
#define boneSlabFilling_h

#include "boneContourStack.h"
#include "boneExecution.h"
#include "bonePieceMatching.h"
#include "boneRingKnit.h"
#include "boneSectionBuilder.h"

namespace bone
{
namespace tiling
{
/** What fills a slab: tetrahedra of vertices of the pool and of vertices of its own. */
struct SlabFilling
{
  std::vector<Vector3>    points;     ///< its own vertices
  std::vector<int>        layers;     ///< of its own vertices
  std::vector<TiledTetra> tetrahedra; ///< own vertex i stands as -1 - i
  int                     slice{ 0 };
  std::vector<int>        separated;  ///< groups whose pieces do not all overlap: they are not joined here
  int                     split{ 0 }; ///< groups whose one piece was split between several
};

/** \brief Fills the space between all sections of two slices, whatever branches, begins or ends there.
 *
 * 1. Each slice's triangulation is completed to one of a box by a constrained Delaunay triangulation of what is outside
 *    the bone, and the two are overlaid (\ref PlanarOverlay).
 *    The upper slice is moved against the lower one first if much more bone lies over bone then.
 * 2. The overlay, placed between the slices, divides the slab: a triangle of a slice and the overlay's triangles in it
 *    span a convex prism, which is filled with tetrahedra from its smallest vertex. They take the region of the slice's
 *    triangle. Where regions lie on top of each other that may not touch (trabecular bone below nothing), or pieces
 * that do not belong together, further layers of prisms with the regions in between separate them. Every step is a
 * terrace now; the mesh is valid, and every interface a 2-manifold, by construction.
 * 3. Where the surfaces should run is known from the contours' distances (\ref FindSlabSurface). The vertices in
 * between are collapsed onto those of the slices wherever orientation (exact) and the link condition for all regions,
 * outside included, allow, and surfaces stay within 0.12 of the slab's height of where they should run: terraces become
 * slopes between the contours, and domes over what begins or ends. As outside is filled with tetrahedra too, no surface
 * can pass through another.
 *
 * With `split`, a piece that has several counterparts is divided between them: surfaces run down to where it is as near
 * to one as to another (\ref PieceCut).
 *
 * Vertices that could not be collapsed are moved to where they should be and stay. Pieces of a group that do not
 * overlap however the slices are moved end and begin there; the group is named in `separated`. Throws
 * std::runtime_error where the contours are too close to be told apart. */
SlabFilling
FillSlab(const ContourStack &         stack,
         const std::vector<Section> & lower,
         const std::vector<Section> & upper,
         const std::vector<Group> &   groups,
         double                       lowerHeight,
         double                       upperHeight,
         const VertexPool &           pool,
         const Execution &            execution,
         bool                         split = false);
} // namespace tiling
} // namespace bone

#endif
