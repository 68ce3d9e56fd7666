/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDicomFragments_h
#define boneDicomFragments_h

class DcmDataset;

namespace bone
{
/** Refuses (\ref Refuse) a compressed DICOM image whose pixels GDCM cannot decode in the memory that rows, columns,
 * samples and bits ask for: fragments that are missing, and codestreams (JPEG, JPEG-LS, JPEG 2000, RLE) that say
 * another size than the file's attributes. GDCM goes beyond its buffers there, or stops the program. DICOM PS3.5,
 * annexes A.4 and G. */
void
RequireWholeFragments(DcmDataset & data);
} // namespace bone

#endif
