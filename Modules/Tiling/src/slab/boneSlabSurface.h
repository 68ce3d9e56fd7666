/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSlabSurface_h
#define boneSlabSurface_h

#include "boneSlabCuts.h"

#include <array>
#include <vector>

namespace bone
{
namespace tiling
{
/** Regions over the height of a slab, from the lower slice to the upper one, of a triangle of the overlay. */
using Column = std::vector<int>;

/** \brief Where the surfaces between two slices should run.
 *
 * Copies of the overlay part the slab; copy p of overlay vertex v has index p * vertices + v. The height is a share of
 * the slab, 0 on the lower slice and 1 on the upper one: where the signed distance to the surface's contours, each in
 * its slice, interpolated over the height, is zero (shape-based interpolation, S. P. Raya & J. K. Udupa,
 * doi:10.1109/42.52980). On the contours themselves it is their slice. A part of a surface that has contours on one
 * slice only rises to half of the slab where it is farthest from them. Where a piece is split, its cut counts as a
 * contour: the surface runs down to it, but for a tenth of the slab, as no surface may meet the inside of a slice. */
struct SlabSurface
{
  std::vector<double>             height; ///< of each copy of each overlay vertex; -1 where no surface passes
  std::vector<std::array<int, 3>> faces;  ///< copies, on the surfaces between the slices
};

/** \param boxes    the slices' triangulations, in the overlay's coordinates
 *  \param regions  region of each triangle of each slice
 *  \param columns  of each triangle of the overlay, all of the same size
 *  \param cuts     of the pieces that are split */
SlabSurface
FindSlabSurface(const std::array<const BoxTriangulation *, 2> & boxes,
                const std::array<const std::vector<int> *, 2> & regions,
                const PlanarOverlay &                           overlay,
                const std::vector<Column> &                     columns,
                const CutDistances &                            cuts);
} // namespace tiling
} // namespace bone

#endif
