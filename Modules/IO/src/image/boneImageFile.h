/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneImageFile_h
#define boneImageFile_h

#include "boneImageIO.h"

#include <itkObject.h>
#include <itkVectorImage.h>

namespace bone
{
/** Keeps ITK's warnings off the standard error stream for its lifetime. */
class QuietItk
{
public:
  QuietItk()
    : m_Before(itk::Object::GetGlobalWarningDisplay())
  {
    itk::Object::GlobalWarningDisplayOff();
  }
  ~QuietItk() { itk::Object::SetGlobalWarningDisplay(m_Before); }
  QuietItk(const QuietItk &) = delete;
  QuietItk &
  operator=(const QuietItk &) = delete;

private:
  bool m_Before;
};

/** What of an image is read at first. */
enum class Reading
{
  Whole,   ///< all
  ByRegion ///< what is asked for later, where the format allows; where it does not, all
};

/** The volume of a file or of a DICOM folder. Throws IOError; whether its voxels are finite is looked at where it is
 * read by regions alone, and can be: in all of the file, or in the slices that are read of a folder. */
VolumeSource::Pointer
OpenVolume(const std::string & path, const std::string & series, std::vector<std::string> & notes, Reading reading);

/** The volume of a file with several values at each voxel; null where each has one. */
itk::VectorImage<float, 3>::Pointer
ReadComponents(const std::string & path);

/** The volume of the chosen series in a folder. */
VolumeSource::Pointer
OpenDicomFolder(const std::string &        folder,
                const std::string &        series,
                std::vector<std::string> & notes,
                Reading                    reading);

/** Throws the IOError of a file whose voxels are not all there. */
[[noreturn]] void
ThrowNotWhole(const std::string & path);

/** Throws IOError where a voxel is not finite. */
void
RequireFinite(const CTImage * image, const std::string & path);

/** Throws IOError where the grid cannot be one in millimetres near the scanner's origin. */
void
RequireSensibleGrid(const CTImage * image, const std::string & path);
} // namespace bone

#endif
