/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneOutlineInterpolation_h
#define boneOutlineInterpolation_h

#include "boneSectionBuilder.h"

namespace bone
{
namespace tiling
{
/** Outlines halfway between those of two planes: for each layer that both have, the zero level of the mean of the
 * signed distances, sampled at the mean spacing of the given loops. A layer that one side lacks is left out. */
std::vector<PieceOutline>
InterpolateOutlines(const std::vector<Vector2> & plane,
                    const std::vector<int> &     layerOfVertex,
                    const std::vector<Section> & lower,
                    const std::vector<Section> & upper);

/** The loop halfway between an outer contour and a hole in it; empty where there is no single one. */
std::vector<Vector2>
HalfwayLoop(const std::vector<Vector2> & outer, const std::vector<Vector2> & hole);
} // namespace tiling
} // namespace bone

#endif
