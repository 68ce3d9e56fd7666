/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSformImageIO_h
#define boneSformImageIO_h

#include <itkImageIOBase.h>

#include <string>

namespace bone
{
/** A reader of a NIfTI-1 file (one file, or the .hdr of a pair) that takes position and axes from its sform alone; null
 * where the file has none, or where its axes are further from right angles than rounding leaves them: by more than 1e-3
 * (cosine), or by more than a tenth of a voxel at the image's end. Spacings are the lengths of the sform's columns.
 *
 * ITK 5.2 refuses files with an sform alone whose voxels are small or whose origin is far (it inverts the matrix in
 * single precision; InsightSoftwareConsortium/ITK issues 2674 and 3333), and those whose axes are rounded. */
itk::ImageIOBase::Pointer
OpenBySform(const std::string & path);
} // namespace bone

#endif
