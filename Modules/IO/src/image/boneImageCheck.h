/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneImageCheck_h
#define boneImageCheck_h

#include <itkImageIOBase.h>

#include <string>

namespace bone
{
/** What a look at the bytes of an image file finds. */
struct ImageFileCheck
{
  bool        known{ false };      ///< the format is one of those that are looked at: NIfTI-1, MetaImage, NRRD
  bool        whole{ true };       ///< all voxels are there, and what is compressed agrees with its checksum
  std::size_t notFinite{ 0 };      ///< voxels that are NaN or infinite
  std::size_t firstNotFinite{ 0 }; ///< number of the first of them, in the file's order
};

/** ITK's readers take a file that is cut short or damaged for whole, and that of NIfTI takes NaN for 0: this looks at
 * the file itself. `io` has read the file's information. */
ImageFileCheck
CheckImageFile(const std::string & path, const itk::ImageIOBase * io);
} // namespace bone

#endif
