/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVoxelRadiograph_h
#define boneVoxelRadiograph_h

#include "boneExecution.h"
#include "boneXRayGeometry.h"

#include <vector>

namespace bone
{
/** Values on a regular grid in space; the first axis runs fastest. */
struct VoxelVolume
{
  std::vector<float> values;
  std::array<int, 3> size{ { 0, 0, 0 } };
  Vector3            origin{ Vector3::Zero() };           ///< centre of voxel (0, 0, 0), mm
  Eigen::Matrix3d    axes{ Eigen::Matrix3d::Identity() }; ///< column k: step of index k, mm
};

/** \brief Line integrals through a voxel image by Joseph's method (IEEE Transactions on Medical Imaging 1(3), 1982).
 *
 * The image reaches half a voxel beyond its outer voxels' centres; there the outer value goes on. A ray is cut at the
 * planes halfway between voxels along the index axis that it follows most; each piece counts with its length times the
 * linearly interpolated value at its middle. The first and last piece end exactly where the ray meets the image's
 * border, the source or the pixel, so that a constant image gives exact chords. `image` receives rows x columns values,
 * row by row, in the grid's unit times mm. The result does not depend on the number of threads. */
void
ProjectVoxels(const VoxelVolume & grid, const XRayGeometry::View & view, const Execution & execution, float * image);
} // namespace bone

#endif
