/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVoxelGrid_h
#define boneVoxelGrid_h

#include "boneTypes.h"

#include <itkImageBase.h>

#include <cmath>

namespace bone
{
/** \struct VoxelGrid
 * \brief Where the voxels of a block of an image lie; the kernels' view of an image's geometry.
 *
 * The voxel (i, j, k), counted from the block's first voxel, has its centre at origin + axes (i, j, k); axes' columns
 * are direction times spacing (mm), so that oblique and anisotropic images are nothing special. */
struct VoxelGrid
{
  std::array<int, 3> size{ { 0, 0, 0 } };
  Eigen::Matrix3d    axes{ Eigen::Matrix3d::Identity() };
  Vector3            origin{ Vector3::Zero() };

  std::size_t
  NumberOfVoxels() const
  {
    return static_cast<std::size_t>(size[0]) * size[1] * size[2];
  }
  double
  VoxelVolume() const
  {
    return std::abs(axes.determinant());
  }
  Vector3
  Centre(int i, int j, int k) const
  {
    return origin + axes * Vector3(i, j, k);
  }
};

/** More voxels than any scan has, and 4 GB of an image of floats: who asks for more has mistaken a unit. */
constexpr double LargestNumberOfVoxels = 1e9;

/** The grid of a region of an image. */
VoxelGrid
MakeVoxelGrid(const itk::ImageBase<3> & image, const itk::ImageRegion<3> & region);
} // namespace bone

#endif
