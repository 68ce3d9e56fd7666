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

/** The volume of a file or of a DICOM folder. Throws IOError; what its voxels are is not looked at. */
CTImage::Pointer
ReadVolume(const std::string & path, const std::string & series, std::vector<std::string> & notes);

/** The volume of a file with several values at each voxel; null where each has one. */
itk::VectorImage<float, 3>::Pointer
ReadComponents(const std::string & path);

/** The volume of the chosen series in a folder. */
CTImage::Pointer
ReadDicomFolder(const std::string & folder, const std::string & series, std::vector<std::string> & notes);

/** Throws IOError where a voxel is not finite. */
void
RequireFinite(const CTImage * image, const std::string & path);

/** Throws IOError where the grid cannot be one in millimetres near the scanner's origin. */
void
RequireSensibleGrid(const CTImage * image, const std::string & path);
} // namespace bone

#endif
