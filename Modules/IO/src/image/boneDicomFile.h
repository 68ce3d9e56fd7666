/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDicomFile_h
#define boneDicomFile_h

#include <string>

namespace bone
{
/** Whether the file has the mark of DICOM files after its preamble. */
bool
IsDicomFile(const std::string & path);

/** Throws IOError where a DICOM file is cut short or its structure damaged, by DCMTK: GDCM, with which ITK reads such
 * files, fills in what is missing or ends the process. */
void
RequireWholeDicomFile(const std::string & path);
} // namespace bone

#endif
