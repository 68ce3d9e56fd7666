/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSlabSide_h
#define boneSlabSide_h

#include "bonePlanarOverlay.h"
#include "boneTilingTypes.h"

#include <vector>

namespace bone
{
namespace tiling
{
/** The triangulation of a slice and of what is outside the bone. */
struct SlabSide
{
  static constexpr int Corners = 4; ///< of the box, the first vertices

  Vector2          shift{ Vector2::Zero() }; ///< subtracted from the slice's coordinates
  BoxTriangulation box;
  std::vector<int> poolId; ///< of each vertex; -1 for the box
  std::vector<int> region; ///< of each triangle; 0 outside
  std::vector<int> group;  ///< of each triangle; -1 outside
  std::vector<int> piece;  ///< of each triangle; -1 outside
};

struct SlabBounds
{
  Vector2 low, high;
};

/** A box around all contours, those of the upper slice moved by -shift. */
SlabBounds
BoundsOf(const VertexPool &           pool,
         const std::vector<Section> & lower,
         const std::vector<Section> & upper,
         const Vector2 &              shift);

/** A slice's triangulation within the bounds, moved by -shift. Throws std::runtime_error where contours touch.
 * \param groupOf  what each section belongs to; -1: nothing */
SlabSide
MakeSide(const VertexPool &           pool,
         const std::vector<Section> & sections,
         const std::vector<int> &     groupOf,
         const SlabBounds &           bounds,
         const Vector2 &              shift);

/** The overlay of both slices' triangulations. Vertices of the upper one that lie on or close to those of the lower one
 * are moved a little, up to some tries. Throws std::runtime_error where the triangulations cannot be overlaid. */
PlanarOverlay
OverlaySides(const SlabSide & lower, const SlabSide & upper, const Execution & execution);
} // namespace tiling
} // namespace bone

#endif
