/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSlabTopology_h
#define boneSlabTopology_h

#include "boneContourCorrespondence.h"
#include "boneContourStack.h"
#include "boneMeshArrays.h"

#include <string>
#include <vector>

namespace bone
{
/** \brief Compares the topology of a mesh with its stack's, slab by slab (ends included).
 *
 * Between two slices the regions from `least` inward are the pieces of both, joined where they overlap if they
 * correspond. Slices overlap where a thin wall leans in several places, specks among them: each place may join, or
 * all of a pair's once, and one of several that is smaller than 0.01 mm^2 need not. A piece that overlaps none may end
 * flat on its slice. Pieces of an inner layer that do not overlap, in pieces of bone that correspond, may be joined or
 * not. So a slab's number of parts and Euler characteristic can have few values; a line for every slab whose mesh has
 * others. Overlaps are found on pixels (mm), up to eight times finer ones where those give other counts. */
std::vector<std::string>
FindSlabsOfOtherTopology(const MeshArrays &            mesh,
                         const ContourStack &          stack,
                         const ContourCorrespondence & correspondence,
                         int                           least,
                         double                        pixel);
} // namespace bone

#endif
