/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSectionBuilder_h
#define boneSectionBuilder_h

#include "boneChordalAxis.h"
#include "boneExecution.h"
#include "bonePieceOutline.h"
#include "boneTilingTypes.h"

namespace bone
{
namespace tiling
{
/** Default of `tolerance` in BuildSection. */
constexpr double CarriedTolerance = 1.12;

/** Triangulates a piece: rings between its loops, the innermost about its medial axis or hole. The medial axis of the
 * piece below, `carried`, is taken on where its ring costs at most `tolerance` times that about the piece's own, so
 * that the walls between axes stay upright. Edges too long for a thin layer are split, which is counted. A piece whose
 * loops do not form a chain, or that has a ring that cannot be triangulated, becomes a patch (\ref BuildPatch). Throws
 * std::runtime_error where contours touch or cross. */
Section
BuildSection(const ContourStack & stack,
             PieceOutline         piece,
             const PlanarTree &   carried,
             double               tolerance,
             int                  slice,
             double               height,
             VertexPool &         pool,
             TilingReport &       report,
             const Execution &    execution);
/** The outer contour of a section in the plane. */
std::vector<Vector2>
OuterPolygon(const std::vector<Vector2> & plane, const Section & section);
} // namespace tiling
} // namespace bone

#endif
