/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneHalfwayLoop_h
#define boneHalfwayLoop_h

#include "boneTypes.h"

#include <vector>

namespace bone
{
namespace tiling
{
/** The loop halfway between an outer contour and a hole in it; empty where there is no single one. */
std::vector<Vector2>
HalfwayLoop(const std::vector<Vector2> & outer, const std::vector<Vector2> & hole);
} // namespace tiling
} // namespace bone

#endif
