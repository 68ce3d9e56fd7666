/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDicomFile_h
#define boneDicomFile_h

#include <array>
#include <string>

namespace bone
{
/** Whether the file has the mark of DICOM files after its preamble. */
bool
IsDicomFile(const std::string & path);

/** What a DICOM file says of its image, that series are told apart by. */
struct DicomHeader
{
  std::string           path;
  std::string           series; ///< SeriesInstanceUID
  std::string           number; ///< SeriesNumber
  std::string           description;
  std::string           modality;
  std::string           instance; ///< SOPInstanceUID
  int                   rows{ 0 };
  int                   columns{ 0 };
  int                   frames{ 1 };
  bool                  image{ false }; ///< has pixels
  bool                  scout{ false };
  bool                  placed{ false }; ///< has a position and an orientation
  std::array<double, 3> position{ {} };
  std::array<double, 3> normal{ {} }; ///< of the slice
};

/** Throws IOError where a DICOM file is cut short or its structure damaged, by DCMTK: GDCM, with which ITK reads such
 * files, fills in what is missing or ends the process. */
DicomHeader
ReadWholeDicomFile(const std::string & path);
} // namespace bone

#endif
