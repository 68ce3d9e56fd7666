/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneImageIO_h
#define boneImageIO_h

#include "boneIOError.h"

#include <itkImage.h>
#include <itkImageSource.h>
#include <itkRGBPixel.h>

#include <string>
#include <vector>

namespace bone
{
/** \defgroup ImageIO Images in ITK's formats
 *
 * Origin, spacing and direction are those of the file, in ITK physical space (LPS, mm). All functions throw IOError:
 * one line that names the file, what is wrong and what to do. ITK's warnings are off while they run.
 * \{ */
using CTImage = itk::Image<float, 3>;
using LabelImage = itk::Image<short, 3>;
using VolumeSource = itk::ImageSource<CTImage>;
using PictureImage = itk::Image<itk::RGBPixel<unsigned char>, 2>;

/** A folder holds several DICOM series, which the message lists. */
class SeveralSeries : public IOError
{
public:
  using IOError::IOError;
};

/** \brief Reads a volume from a file, or a DICOM series from a folder and the folders in it.
 *
 * Refuses what is missing, no image, 2D or 4D, of one slice, with several components per voxel, with voxels that are
 * NaN or infinite, or with a direction that is not orthonormal (ITK cannot hold a sheared grid). A DICOM series must
 * have slice positions that are evenly spaced (each within 5 % of the spacing) and lie along the slices' normal (no
 * gantry tilt). `series` is the number, UID or description of a series; where it is empty and the folder holds several
 * volumes, SeveralSeries is thrown. Scouts, images without a place and copies of a file are passed over, which `notes`
 * is told.
 */
CTImage::Pointer
ReadCT(const std::string & path, const std::string & series = "", std::vector<std::string> * notes = nullptr);

/** \brief The same, of which voxels are read where a filter asks for them, by the regions it needs.
 *
 * The source's output has its grid and no voxels. All of the file is looked at first, as ReadCT does, a block at a
 * time; of what is compressed, a few MB are kept by which any part of it is found again. Of a DICOM folder the headers
 * are looked at first, and the voxels of the slices that are read. Formats that are none of NIfTI-1, MetaImage, NRRD
 * (each with its voxels in one file, raw or of zlib) and DICOM slices are read as a whole. The output holds what was
 * asked for last, until it was used. The file must stay as it is while the source is in use. */
VolumeSource::Pointer
OpenCT(const std::string & path, const std::string & series = "", std::vector<std::string> * notes = nullptr);

/** ReadCT for a label map, whose voxels must be whole numbers from -32768 to 32767 in whatever type. What its header
 * says of its labels (\ref StatesOneBone) is kept. Refuses a .seg.nrrd with overlapping segments, which ReadLabelFile
 * reads. */
LabelImage::Pointer
ReadLabels(const std::string & path);

/** Reads a radiograph: a 2D image, or a 3D image one pixel thick along its third axis. */
CTImage::Pointer
ReadRadiograph(const std::string & path);

/** How many voxels a volume has along each axis, from its header alone. `series` is as in ReadCT. */
CTImage::SizeType
ReadVolumeSize(const std::string & path, const std::string & series = "");

/** Whether a volume's voxels lie, or may lie, in another file than the one named. */
bool
HasDetachedVoxels(const std::string & path);

/** Write the whole file (with its data file, for formats of two) or none; the format is that of the name's extension
 * (.nii.gz, .mha, .nrrd, .png, ...). What was written is read back before it takes its name, since not every format's
 * writer notices a full disk. Label maps are compressed where the format can. Where itkImageFileWriter.h is included
 * too, write bone::WriteImage: with a smart pointer, the name alone means ITK's function, which does none of this. */
void
WriteImage(const CTImage * image, const std::string & path);
void
WriteImage(const LabelImage * image, const std::string & path);
void
WriteImage(const itk::Image<float, 2> * image, const std::string & path);
/** Pictures are written as .png, of 8 or 16 bits. */
void
WriteImage(const itk::Image<unsigned char, 2> * image, const std::string & path);
void
WriteImage(const itk::Image<unsigned short, 2> * image, const std::string & path);
void
WriteImage(const PictureImage * image, const std::string & path);
/** \} */
} // namespace bone

#endif
