/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSlabCuts_h
#define boneSlabCuts_h

#include "boneContourDistance.h"
#include "bonePieceMatching.h"
#include "boneSlabSide.h"

#include <array>
#include <vector>

namespace bone
{
namespace tiling
{
/** A piece of a slice that is split between several of the other one, in a slab that is filled (paper 2.6): each point
 * of it belongs to the counterpart that is nearest to it, the slices lying as they are overlaid. */
struct PieceCut
{
  int                          side;         ///< 0: the piece is on the lower slice
  int                          group;        ///< that it and its counterparts belong to
  std::vector<ContourDistance> counterparts; ///< distances to their outer contours

  /** Distance, to first order, from a point to where it would be as near to another counterpart. */
  double
  DistanceToCut(const Vector2 & q) const;
};

/** The cuts of all groups with one piece on a slice and several on the other one, which is moved by -shift if it is the
 * upper one. */
std::vector<PieceCut>
FindPieceCuts(const VertexPool &           pool,
              const std::vector<Section> & lower,
              const std::vector<Section> & upper,
              const std::vector<Group> &   groups,
              const Vector2 &              shift);

/** Distance of the overlay's vertices to the cuts of the pieces of either slice that they lie in; infinite elsewhere.
 */
using CutDistances = std::array<std::vector<double>, 2>;

CutDistances
MeasureCuts(const std::vector<PieceCut> &           cuts,
            const std::array<const SlabSide *, 2> & sides,
            const PlanarOverlay &                   overlay);
} // namespace tiling
} // namespace bone

#endif
