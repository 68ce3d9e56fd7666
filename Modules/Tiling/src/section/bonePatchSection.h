/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePatchSection_h
#define bonePatchSection_h

#include "bonePieceOutline.h"
#include "boneTilingTypes.h"

namespace bone
{
namespace tiling
{
/** Triangulates a piece of any shape (several inner contours, holes, layers too thin for rings) by a constrained
 * Delaunay triangulation of its contours and medial axes: a section without rings. Throws std::runtime_error where
 * contours touch or cross. */
Section
BuildPatch(const ContourStack & stack, const PieceOutline & piece, int slice, double height, VertexPool & pool);
} // namespace tiling
} // namespace bone

#endif
