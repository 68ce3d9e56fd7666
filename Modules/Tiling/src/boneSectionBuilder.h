/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSectionBuilder_h
#define boneSectionBuilder_h

#include "boneContourStack.h"
#include "boneRingTriangulation.h"
#include "boneTilingReport.h"
#include "boneTilingTypes.h"

namespace bone
{
namespace tiling
{
/** Default of `tolerance` in BuildSection. */
constexpr double CarriedTolerance = 1.12;

/** One nested piece of a slice before it is triangulated: polygons in the plane, all counter-clockwise. */
struct PieceOutline
{
  struct Loop
  {
    std::vector<Vector2> points;
    int                  layer{ 0 };
    int                  region{ 1 };
    int                  id{ 0 };
  };
  /** Outside in, each inside the one before. */
  std::vector<Loop> loops;
  /** A hole in the bone; empty where there is none. */
  std::vector<Vector2> hole;
  /** Medial axis of the innermost loop as given; without points where none was. */
  std::vector<std::vector<Vector2>> axis;
};

/** Sorts the contours of a slice into nested pieces. What the tiling cannot take (a second inner contour of the same
 * layer, a second hole, an inner contour beside a hole) is left out and counted in the report. */
std::vector<PieceOutline>
CollectPieces(const ContourStack & stack, std::size_t slice, TilingReport & report);

/** Triangulates a piece: rings between its loops, the innermost about its medial axis or hole. The medial axis of the
 * piece below, `carried`, is taken on where its ring costs at most `tolerance` times that about the piece's own, so
 * that the walls between axes stay upright. Edges too long for a thin layer are split; a loop whose ring cannot be
 * triangulated is left out. Both are counted. Throws std::runtime_error where even the outer contour alone cannot be
 * triangulated (it crosses itself). */
Section
BuildSection(const ContourStack & stack,
             PieceOutline         piece,
             const PlanarTree &   carried,
             double               tolerance,
             int                  slice,
             double               height,
             VertexPool &         pool,
             TilingReport &       report);
/** The outer contour of a section in the plane. */
std::vector<Vector2>
OuterPolygon(const std::vector<Vector2> & plane, const Section & section);

/** Which pieces of a slice belong to which of the next. */
struct Group
{
  std::vector<int> lower;
  std::vector<int> upper;
};

/** Corresponding pieces of two slices by overlap of their outer contours, and by distance where a piece overlaps none
 * (paper 2.5). Each group has a single piece on one side at least; a piece without counterpart is a group of its own.
 */
std::vector<Group>
MatchPieces(const std::vector<std::vector<Vector2>> & lower,
            const std::vector<std::vector<Vector2>> & upper,
            double                                    slabHeight);
} // namespace tiling
} // namespace bone

#endif
