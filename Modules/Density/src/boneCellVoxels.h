/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCellVoxels_h
#define boneCellVoxels_h

#include "boneBernstein.h"

#include <vector>

namespace bone
{
/** A voxel whose centre lies in a tetrahedron. */
struct CellVoxel
{
  std::array<int, 3> index; ///< counted from the block's first voxel
  Barycentric        mu;
};

/** The voxels of a block of the given size whose centres lie in the tetrahedron with these vertices (columns, index
 * coordinates), its faces included, by rising k, j, i. A flat or inverted tetrahedron has them alike as long as its
 * volume is not 0. */
void
FindCellVoxels(const Eigen::Matrix<double, 3, 4> & vertices,
               const std::array<int, 3> &          size,
               std::vector<CellVoxel> &            voxels);
} // namespace bone

#endif
