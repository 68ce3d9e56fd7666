/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelOutline.h"

#include <itkImageRegionConstIteratorWithIndex.h>

#include <algorithm>
#include <cmath>
#include <vector>

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
  std::vector<itk::OffsetValueType> others; // places in the buffer
  for (itk::ImageRegionConstIteratorWithIndex<LabelImage> it(&labels, region); !it.IsAtEnd(); ++it)
  {
    if (!isInside(it.Get()))
    {
      continue;
    }
    const std::size_t before = outline.faces.size();
    const Vector3     centre = CentreOf(labels, it.GetIndex());
    for (int k = 0; k < faces; ++k)
    {
      const unsigned int axis = k / 2;
      auto               index = it.GetIndex();
      index[axis] += k % 2 == 0 ? -1 : 1;
      if (region.IsInside(index) && !isInside(labels.GetPixel(index)))
      {
        const Vector3 other = CentreOf(labels, index);
        outline.faces.push_back({ 0.5 * (centre + other), (other - centre).normalized(), volume / spacing[axis] });
        others.push_back(labels.ComputeOffset(index));
      }
    }
    if (outline.faces.size() > before)
    {
      outline.voxels.push_back({ centre, true });
    }
  }
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  for (const itk::OffsetValueType place : others)
  {
    outline.voxels.push_back({ CentreOf(labels, labels.ComputeIndex(place)), false });
  }
  return outline;
}
} // namespace bone
