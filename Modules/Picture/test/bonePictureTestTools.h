/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePictureTestTools_h
#define bonePictureTestTools_h

#include "boneCanvas.h"

#include <array>
#include <cstdlib>

namespace bone
{
inline Color
PixelOf(const PictureImage * image, long column, long row)
{
  const auto pixel = image->GetPixel({ { column, row } });
  return { { pixel[0], pixel[1], pixel[2] } };
}

/** How many pixels of an image have a color, each channel within a tolerance. */
inline int
CountColor(const PictureImage * image, const Color & color, int tolerance = 0)
{
  int        count = 0;
  const auto size = image->GetLargestPossibleRegion().GetSize();
  for (std::size_t k = 0; k < size[0] * size[1]; ++k)
  {
    bool same = true;
    for (unsigned int i = 0; i < 3; ++i)
    {
      same = same && std::abs(image->GetBufferPointer()[k][i] - color[i]) <= tolerance;
    }
    count += same ? 1 : 0;
  }
  return count;
}
} // namespace bone

#endif
