/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCubicSampler_h
#define boneCubicSampler_h

#include "boneExecution.h"
#include "boneVoxelGrid.h"

#include <cmath>
#include <vector>

namespace bone
{
/** \class CubicSampler
 * \brief Cubic B-spline interpolation in a block of voxels: through the voxels' values, with continuous second
 * derivatives (M. Unser, doi:10.1109/79.799930).
 *
 * The block's mirror images continue it; beyond the outermost voxel centres the value is that of the nearest point
 * between them, as with LinearSampler. Making it is O(voxels) and takes 4 bytes for each. Const use is safe from many
 * threads. */
class CubicSampler
{
public:
  /** `values`: the voxels, first axis fastest; becomes the spline's coefficients. Throws std::invalid_argument where
   * their number is not that of the size. */
  CubicSampler(std::vector<float> values, const std::array<int, 3> & size, const Execution & execution = Execution());

  double
  operator()(const Vector3 & index) const;

private:
  std::vector<float> m_Coefficients;
  std::array<int, 3> m_Size;
};
} // namespace bone

#endif
