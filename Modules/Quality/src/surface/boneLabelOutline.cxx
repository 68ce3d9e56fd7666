/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelOutline.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace bone
{
namespace
{
using Grid = itk::ImageBase<3>;

Vector3
CentreOf(const Grid & image, const Grid::IndexType & index)
{
  const auto place = image.TransformIndexToPhysicalPoint<double>(index);
  return { place[0], place[1], place[2] };
}
} // namespace

LabelOutline
FindOutline(const Grid & image, const std::vector<unsigned char> & inside)
{
  constexpr int faces = 6;
  const auto    region = image.GetBufferedRegion();
  const auto    spacing = image.GetSpacing();
  const double  volume = spacing[0] * spacing[1] * spacing[2];
  LabelOutline  outline;
  outline.spacing = std::cbrt(volume);
  std::vector<itk::OffsetValueType> others; // places in the buffer
  for (std::size_t v = 0; v < inside.size(); ++v)
  {
    if (inside[v] == 0)
    {
      continue;
    }
    const auto        place = image.ComputeIndex(static_cast<itk::OffsetValueType>(v));
    const std::size_t before = outline.faces.size();
    const Vector3     centre = CentreOf(image, place);
    for (int k = 0; k < faces; ++k)
    {
      const unsigned int axis = k / 2;
      auto               index = place;
      index[axis] += k % 2 == 0 ? -1 : 1;
      if (!region.IsInside(index))
      {
        continue;
      }
      const itk::OffsetValueType neighbour = image.ComputeOffset(index);
      if (inside[static_cast<std::size_t>(neighbour)] == 0)
      {
        const Vector3 other = CentreOf(image, index);
        outline.faces.push_back({ 0.5 * (centre + other), (other - centre).normalized(), volume / spacing[axis] });
        others.push_back(neighbour);
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
    outline.voxels.push_back({ CentreOf(image, image.ComputeIndex(place)), false });
  }
  return outline;
}
} // namespace bone
