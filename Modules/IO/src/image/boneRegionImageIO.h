/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRegionImageIO_h
#define boneRegionImageIO_h

#include "boneImageCheck.h"

#include <memory>

namespace bone
{
/** A reader of plain voxels (\ref ImageVoxels) that holds no more than the region asked for, compressed or not; all
 * else is as `io` has read it. Values are those that ITK's own readers give. Throws IOError where voxels are not there.
 */
itk::ImageIOBase::Pointer
ReadByRegion(const itk::ImageIOBase * io, const ImageVoxels & voxels, std::shared_ptr<VoxelFile> file);
} // namespace bone

#endif
