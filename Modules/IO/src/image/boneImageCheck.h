/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneImageCheck_h
#define boneImageCheck_h

#include "boneVoxelFile.h"

#include <itkImageIOBase.h>

#include <optional>
#include <string>

namespace bone
{
/** What is known of an image file's voxels before they are read. */
struct ImageVoxels
{
  bool known{ false }; ///< the format is one of those that are looked at: NIfTI-1, MetaImage, NRRD
  bool whole{ true };  ///< the file is long enough, and what it names is there
  /** Where they are; nothing where they are in several files or written as text. */
  std::optional<VoxelPlace> place;
  /** Whether they can be taken from there as they are. */
  bool                 plain{ false };
  bool                 swapped{ false }; ///< their bytes
  itk::IOComponentEnum component{ itk::IOComponentEnum::UNKNOWNCOMPONENTTYPE };
  bool                 rescaled{ false }; ///< values are slope * voxel + intercept
  double               slope{ 1.0 };
  double               intercept{ 0.0 };
};

/** `io` has read the file's information. */
ImageVoxels
FindVoxels(const std::string & path, const itk::ImageIOBase * io);

/** What a look at the voxels finds. */
struct VoxelCheck
{
  bool        whole{ true };       ///< all are there, and what is compressed agrees with its checksum
  std::size_t notFinite{ 0 };      ///< voxels that are NaN or infinite
  std::size_t firstNotFinite{ 0 }; ///< number of the first of them, in the file's order
};

/** ITK's readers take a file that is cut short or damaged for whole, and that of NIfTI takes NaN for 0: this looks at
 * the file itself. */
VoxelCheck
CheckVoxels(const ImageVoxels & voxels, VoxelFile & file);
} // namespace bone

#endif
