/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourTiler_h
#define boneContourTiler_h

#include "boneContourStack.h"
#include "boneExecution.h"
#include "boneMeshArrays.h"
#include "boneTilingMetric.h"
#include "boneTilingParameters.h"
#include "boneTilingReport.h"

#include <memory>

namespace bone
{
/** What the tiling is given beside the contours. */
struct TilingGuide
{
  /** Cost of the knit's steps; span length where none is set. */
  std::shared_ptr<const TilingMetric> metric;
  /** Correspondence of pieces in some slabs, used there in place of overlap and distance. */
  std::shared_ptr<const ContourCorrespondence> correspondence;
  /** How several pieces are tiled with one. */
  BranchingKind branching{ BranchingKind::Composite };
};

/** \brief Tiles a stack of nested contours into a layered, conforming tetrahedral mesh (paper 2.2 to 2.6).
 *
 * 1. Each slice is triangulated once: the rings between its nested contours and about the medial axis. Both slabs that
 *    meet at the slice share these triangles (continuity between slices).
 * 2. Pieces of neighbouring slices are matched by overlap and distance; several pieces against one are joined by
 *    bridges into a composite contour, or the one is split into parts, or the slab is filled (TilingGuide::branching);
 *    a layer that is missing on one side collapses onto the next contour inward.
 * 3. Each pair is knitted from the inside out: the wall between the medial axes first, then ring after ring, the wall
 *    between two layers being tiled once and prescribed to the ring outside it (continuity between layers).
 * 4. Ends are closed by a ridge above the medial axis; where the bone leaves the image they are cut flat.
 * 5. A slab that cannot be knitted in this way (pieces that no chain of rings describes, bends that invert tetrahedra,
 *    walls that would cross or are twisted) is filled as a whole from the overlay of its slices' triangulations, which
 *    is always possible; vertices between the slices stay where they cannot be removed.
 *
 * A hole that is bone above and below would be a void; it is closed and counted. Orientation is decided by exact
 * predicates and the result is validated: the function returns a valid mesh or throws std::runtime_error naming the
 * slice (a given correspondence that names a contour which is not there, or pieces that lie beside each other and
 * cannot be joined; where no correspondence was given, such pieces end and begin there, and the report says so).
 *
 * The stack's contours must be simple and nested (\ref ContourStack::Verify). Layer, slice and region of the result:
 * \ref MeshArrays. The result does not depend on the number of threads. Throws itk::ProcessAborted where `execution` is
 * aborted; `report` then holds what was met until then. */
MeshArrays
TileContours(const ContourStack & stack,
             const TilingGuide &  guide,
             TilingReport &       report,
             const Execution &    execution = Execution());
} // namespace bone

#endif
