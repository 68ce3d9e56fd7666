/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVolumeView_h
#define boneVolumeView_h

#include "boneVoxelGrid.h"

namespace bone
{
/** \struct VolumeView
 * \brief Voxels of an image that somebody else keeps, x fastest, and where they lie. */
struct VolumeView
{
  VolumeView(const VoxelGrid & voxelGrid, const float * voxels)
    : grid(voxelGrid)
    , toIndex(voxelGrid.axes.inverse())
    , values(voxels)
  {}

  VoxelGrid       grid;
  Eigen::Matrix3d toIndex; ///< inverse of the grid's axes
  const float *   values;

  /** Trilinear value at x (mm), and its gradient (per mm) unless null. False beyond the outermost voxel centres. */
  bool
  Sample(const Vector3 & x, double & value, Vector3 * gradient = nullptr) const;
};

} // namespace bone

#endif
