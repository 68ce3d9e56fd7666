/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneXRayHeader_h
#define boneXRayHeader_h

#include "boneXRayIO.h"

namespace bone
{
/** How stored pixels become values: offset + slope * stored. */
struct XRayScale
{
  double slope{ 1.0 };
  double offset{ 0.0 };
};

/** All of a DICOM X-ray file but its pixels. Throws IOError. */
XRayFile
ReadXRayHeader(const std::string & path, XRayScale & scale, Vector2 & spacing);

/** The pixels, as stored, row by row, by GDCM, which knows the compressed ones. Throws IOError. */
std::vector<float>
ReadStoredPixels(const std::string & path, std::array<int, 2> & size);
} // namespace bone

#endif
