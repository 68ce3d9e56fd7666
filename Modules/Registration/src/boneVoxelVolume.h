/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVoxelVolume_h
#define boneVoxelVolume_h

#include "boneExecution.h"
#include "boneMeshArrays.h"
#include "boneVolumeView.h"

#include <functional>
#include <vector>

namespace bone
{
/** \struct VoxelVolume
 * \brief A small image of its own. */
struct VoxelVolume
{
  VoxelGrid          grid;
  std::vector<float> values;

  VolumeView
  View() const
  {
    return { grid, values.data() };
  }
};

/** Means of blocks of voxels, each value changed by `map` first; blocks are as many voxels wide as come to about
 * `spacing` mm along each axis. Voxels beyond the last whole block are left out, but for axes with less than one. */
VoxelVolume
AverageBlocks(const VolumeView &                    volume,
              double                                spacing,
              const std::function<double(double)> & map,
              const Execution &                     execution);

/** How much a voxel looks like dense bone, 0 to 1, by its density (HU): what poses are searched for by. Soft tissue,
 * marrow, fat and air are alike. */
double
BoneLikeness(double density);

/** The densities of a mesh on a grid along the axes of its space, with soft tissue about it as far as `margin` mm. */
VoxelVolume
RasterizeMesh(const MeshArrays & mesh, double spacing, double margin, double softTissue, const Execution & execution);
} // namespace bone

#endif
