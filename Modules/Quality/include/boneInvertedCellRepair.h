/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneInvertedCellRepair_h
#define boneInvertedCellRepair_h

#include "boneTetraComplex.h"

namespace bone
{
/** \brief Moves points until no cell is flat or inverted, as far as that can be done without moving the boundary.
 *
 * Each point of a bad cell goes where the smallest signed volume of the cells around it is largest, which is a concave
 * problem for one point (L. A. Freitag, P. Plassmann, "Local simplicial mesh untangling and improvement", 2000); solved
 * by a pattern search. Interface points stay on their interface, points of the boundary, of curves and corners where
 * they are. Returns the number of cells that are still flat or inverted (exact). */
std::size_t
RepairInvertedCells(TetraComplex & complex);
} // namespace bone

#endif
