/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRadiographPicture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
/** The value below which this share of the values lies; 0 of none. */
double
ValueAtShare(std::vector<float> & values, double share)
{
  if (values.empty())
  {
    return 0.0;
  }
  const auto place = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

GreyScale
MakeScale(double lower, double upper, bool whiteAtUpper)
{
  upper = upper > lower ? upper : lower + 1.0; // an image of one value is black, or white
  return whiteAtUpper ? GreyScale{ lower, upper } : GreyScale{ upper, lower };
}

template <typename TPixel>
void
WriteGrey(const CTImage * image, const GreyScale & scale, const std::string & path)
{
  using Picture = itk::Image<TPixel, 2>;
  const auto size = image->GetBufferedRegion().GetSize();
  auto       picture = Picture::New();
  picture->SetRegions(typename Picture::SizeType{ { size[0], size[1] } });
  picture->Allocate();
  constexpr double white = std::numeric_limits<TPixel>::max();
  const float *    from = image->GetBufferPointer();
  std::transform(from, from + size[0] * size[1], picture->GetBufferPointer(), [&scale](float value) {
    const double share = (value - scale.black) / (scale.white - scale.black);
    return static_cast<TPixel>(std::lround(white * std::clamp(share, 0.0, 1.0)));
  });
  WriteImage(picture.GetPointer(), path);
}
} // namespace

GreyScale
ScaleOfIntegrals(const CTImage * image, const PictureOptions & options)
{
  if (!options.window.empty())
  {
    return MakeScale(options.window[0], options.window[1], !options.inverted);
  }
  std::vector<float> values;
  const float *      pixels = image->GetBufferPointer();
  std::copy_if(pixels,
               pixels + image->GetBufferedRegion().GetNumberOfPixels(),
               std::back_inserter(values),
               [](float value) { return value != 0.0f; });
  const double upper = ValueAtShare(values, 0.995);
  return MakeScale(upper > 0.0 ? 0.0 : ValueAtShare(values, 0.005), upper, !options.inverted);
}

GreyScale
ScaleOfIntensities(const CTImage * image, double incident, const PictureOptions & options)
{
  if (!options.window.empty())
  {
    return MakeScale(options.window[0], options.window[1], options.inverted);
  }
  const float *      pixels = image->GetBufferPointer();
  std::vector<float> values(pixels, pixels + image->GetBufferedRegion().GetNumberOfPixels());
  return MakeScale(ValueAtShare(values, 0.005), incident, options.inverted);
}

void
WriteRadiographPicture(const CTImage * image, const GreyScale & scale, int bits, const std::string & path)
{
  bits == 16 ? WriteGrey<unsigned short>(image, scale, path) : WriteGrey<unsigned char>(image, scale, path);
}
} // namespace bone
