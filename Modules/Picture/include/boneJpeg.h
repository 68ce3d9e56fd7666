/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneJpeg_h
#define boneJpeg_h

#include "boneImageIO.h"

#include <string>

namespace bone
{
/** The bytes of a JPEG file, for pages, where it takes a third of a PNG's; colours at full resolution, so that letters
 * stay sharp. `quality`: 1..100. Throws std::invalid_argument where it is another, or the picture is empty. */
std::string
ToJpeg(const PictureImage * picture, int quality = 78);
} // namespace bone

#endif
