/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLayerLinks_h
#define boneLayerLinks_h

#include "bonePlanarOverlay.h"

#include <array>
#include <set>
#include <vector>

namespace bone
{
namespace tiling
{
/** A layer (all from a region inward; negative: all that is not, such as holes), and the parts of it on the lower and
 * upper slice, each named by its first vertex there. */
using LayerLink = std::array<int, 3>;

/** Parts of layers of two slices that lie over each other: by more than a share of the
 * smaller one's area; of the bone in pieces that belong together.
 * \param boxes    the slices' triangulations, in the overlay's coordinates
 * \param regions  region of each triangle of each slice, 0 outside
 * \param groups   what each triangle's piece belongs to, -1 outside */
std::set<LayerLink>
FindLayerLinks(const std::array<const BoxTriangulation *, 2> & boxes,
               const std::array<const std::vector<int> *, 2> & regions,
               const std::array<const std::vector<int> *, 2> & groups,
               const PlanarOverlay &                           overlay,
               double                                          share);
} // namespace tiling
} // namespace bone

#endif
