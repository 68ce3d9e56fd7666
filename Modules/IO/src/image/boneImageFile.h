/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneImageFile_h
#define boneImageFile_h

#include "boneImageIO.h"

#include <itkObject.h>

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

/** The one image series among the DICOM files of a folder. Throws IOError; voxels are not looked at. */
CTImage::Pointer
ReadDicomSeries(const std::string & folder);
} // namespace bone

#endif
