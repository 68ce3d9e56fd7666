/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelOutline.h"

#include <itkImageRegionConstIteratorWithIndex.h>

#include <cmath>

namespace bone
{
namespace
{
using LabelImage = itk::Image<short, 3>;

Vector3
CentreOf(const LabelImage & labels, const LabelImage::IndexType & index)
{
  const auto place = labels.TransformIndexToPhysicalPoint<double>(index);
  return { place[0], place[1], place[2] };
}
} // namespace

LabelOutline
FindOutline(const LabelImage & labels, short label)
{
  constexpr int faces = 6;
  const auto    isInside = [label](short value) { return label == 0 ? value != 0 : value == label; };
  const auto    region = labels.GetBufferedRegion();
  const auto    spacing = labels.GetSpacing();
  const double  volume = spacing[0] * spacing[1] * spacing[2];
  LabelOutline  outline;
  outline.spacing = std::cbrt(volume);
  for (itk::ImageRegionConstIteratorWithIndex<LabelImage> it(&labels, region); !it.IsAtEnd(); ++it)
  {
    const bool inside = isInside(it.Get());
    bool       atOutline = false;
    for (int k = 0; k < faces; ++k)
    {
      const unsigned int axis = k / 2;
      auto               index = it.GetIndex();
      index[axis] += k % 2 == 0 ? -1 : 1;
      if (!region.IsInside(index) || isInside(labels.GetPixel(index)) == inside)
      {
        continue;
      }
      atOutline = true;
      if (inside)
      {
        const Vector3 centre = CentreOf(labels, it.GetIndex()), other = CentreOf(labels, index);
        outline.faces.push_back({ 0.5 * (centre + other), (other - centre).normalized(), volume / spacing[axis] });
      }
    }
    if (atOutline)
    {
      outline.voxels.push_back({ CentreOf(labels, it.GetIndex()), inside });
    }
  }
  return outline;
}
} // namespace bone
