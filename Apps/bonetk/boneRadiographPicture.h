/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographPicture_h
#define boneRadiographPicture_h

#include "boneImageIO.h"

#include <string>
#include <vector>

namespace bone
{
/** How a radiograph becomes a picture (.png). */
struct PictureOptions
{
  std::vector<double> window; ///< lower and upper value; empty: chosen by the pixels
  int                 bits{ 8 };
  bool                inverted{ false }; ///< what attenuates more is darker
};

/** The values that are black and white; those between lie on a line, those beyond are black and white too. */
struct GreyScale
{
  double black;
  double white;
};

/** The scale of line integrals: white at the upper end of the window, by default from 0 to the 99.5th percentile of the
 * pixels that are not 0 (from their 0.5th where that is not above 0). */
GreyScale
ScaleOfIntegrals(const CTImage * image, const PictureOptions & options);

/** The scale of intensities: white at the lower end, by default from the 0.5th percentile of the pixels to the incident
 * intensity. */
GreyScale
ScaleOfIntensities(const CTImage * image, double incident, const PictureOptions & options);

/** Writes a radiograph as a greyscale PNG of 8 or 16 bits. Throws IOError. */
void
WriteRadiographPicture(const CTImage * image, const GreyScale & scale, int bits, const std::string & path);
} // namespace bone

#endif
