/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSliceSelection_h
#define boneSliceSelection_h

#include "boneContourStack.h"
#include "boneExecution.h"

#include <vector>

namespace bone
{
/** Which slices of a stack to keep. */
struct SliceSelection
{
  std::vector<std::size_t> slices;        ///< ascending; the first and the last slice with contours are among them
  double                   volume{ 0.0 }; ///< misplaced between them, mm^3
};

/** \brief Chooses the `count` slices from which the others are best told.
 *
 * A slice that is left out is told from the two kept around it by shape-based interpolation (S. P. Raya & J. K. Udupa,
 * doi:10.1109/42.52980): the area between what that gives and its own contours, times its share of the height, is the
 * volume misplaced. Periosteal contours with their holes count fully, endosteal ones by a quarter. The least sum over
 * the stack is found by dynamic programming, so that slices gather where sections change: at level surfaces, where
 * pieces split, join and end.
 *
 * Neighbours among those kept lie at most `maximumGap` (mm) apart where the stack allows; as many more slices than
 * `count` are kept as that needs. Slices without contours are told by the same rule. O(slices * gap^2) comparisons of
 * planes, in parallel. \pre the stack has a slice with contours. */
SliceSelection
SelectSlices(const ContourStack & stack, std::size_t count, double maximumGap, const Execution & execution);
} // namespace bone

#endif
