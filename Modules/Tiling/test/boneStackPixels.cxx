/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStackPixels.h"

#include <itkConnectedComponentImageFilter.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
/** The region at each pixel of a slice: that of the smallest contour it lies in. */
std::vector<int>
Regions(const ContourStack & stack, const ContourSlice & slice, const PixelGrid & grid)
{
  std::vector<int> regions(static_cast<std::size_t>(grid.nx) * grid.ny, 0);
  for (const PlaneContour & contour : PlaneContoursOf(stack, slice))
  {
    FillPolygon(grid, contour.polygon, contour.region, regions);
  }
  return regions;
}

StackMask::Pointer
MaskOf(const ContourStack & stack, int least, double pixel)
{
  const PixelGrid grid = PixelGridOf(stack, pixel);
  auto            mask = StackMask::New();
  // A slice of background on either side joins all that is outside.
  mask->SetRegions(StackMask::SizeType{ { static_cast<itk::SizeValueType>(grid.nx),
                                          static_cast<itk::SizeValueType>(grid.ny),
                                          stack.GetSlices().size() + 2 } });
  mask->Allocate(true);
  unsigned char * out = mask->GetBufferPointer();
  for (const ContourSlice & slice : stack.GetSlices())
  {
    out += static_cast<std::ptrdiff_t>(grid.nx) * grid.ny;
    const auto regions = Regions(stack, slice, grid);
    std::transform(regions.begin(), regions.end(), out, [least](int r) { return r >= least; });
  }
  return mask;
}

StackMask::Pointer
Complement(const StackMask * mask)
{
  auto other = StackMask::New();
  other->SetRegions(mask->GetLargestPossibleRegion());
  other->Allocate();
  const auto n = mask->GetLargestPossibleRegion().GetNumberOfPixels();
  std::transform(mask->GetBufferPointer(),
                 mask->GetBufferPointer() + n,
                 other->GetBufferPointer(),
                 [](unsigned char v) { return v == 0; });
  return other;
}

} // namespace

PixelGrid
PixelGridOf(const ContourStack & stack, double pixel)
{
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      for (const Vector3 & p : contour.points)
      {
        low = low.cwiseMin(stack.ToPlane(p));
        high = high.cwiseMax(stack.ToPlane(p));
      }
    }
  }
  const Vector2 size = (high - low) / pixel;
  return {
    low - Vector2::Constant(1.5 * pixel), pixel, static_cast<int>(size.x()) + 4, static_cast<int>(size.y()) + 4
  };
}

std::vector<PlaneContour>
PlaneContoursOf(const ContourStack & stack, const ContourSlice & slice)
{
  std::vector<PlaneContour> contours;
  for (const Contour & contour : slice.contours)
  {
    if (!contour.axis)
    {
      contours.push_back({ {}, contour.region, contour.layer, contour.id, -1 });
      for (const Vector3 & p : contour.points)
      {
        contours.back().polygon.push_back(stack.ToPlane(p));
      }
    }
  }
  std::stable_sort(contours.begin(), contours.end(), [](const PlaneContour & a, const PlaneContour & b) {
    return std::abs(SignedArea(a.polygon)) > std::abs(SignedArea(b.polygon));
  });
  for (std::size_t c = 0; c < contours.size(); ++c)
  {
    for (std::size_t other = 0; other < c; ++other)
    {
      if (PointInPolygon(contours[c].polygon.front(), contours[other].polygon))
      {
        contours[c].parent = static_cast<int>(other);
      }
    }
  }
  return contours;
}

void
FillPolygon(const PixelGrid & grid, const std::vector<Vector2> & polygon, int value, std::vector<int> & slice)
{
  for (int j = 0; j < grid.ny; ++j)
  {
    const double        y = grid.low.y() + j * grid.pixel;
    std::vector<double> crossings;
    for (std::size_t i = 0; i < polygon.size(); ++i)
    {
      const Vector2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      if ((a.y() <= y) != (b.y() <= y))
      {
        crossings.push_back(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
      }
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    {
      const auto first = static_cast<int>(std::ceil((crossings[i] - grid.low.x()) / grid.pixel));
      const auto last = static_cast<int>(std::floor((crossings[i + 1] - grid.low.x()) / grid.pixel));
      for (int x = first; x <= last; ++x)
      {
        slice[static_cast<std::size_t>(j) * grid.nx + x] = value;
      }
    }
  }
}

StackLabels::Pointer
LabelParts(StackMask * mask, bool corners, int & count)
{
  auto filter = itk::ConnectedComponentImageFilter<StackMask, StackLabels>::New();
  filter->SetInput(mask);
  filter->SetFullyConnected(corners);
  filter->Update();
  count = static_cast<int>(filter->GetObjectCount());
  return filter->GetOutput();
}

StackMask::Pointer
PixelsInside(const ContourStack & stack, int least, double pixel, int & outside)
{
  StackMask::Pointer         mask = MaskOf(stack, least, pixel);
  const StackLabels::Pointer around = LabelParts(Complement(mask), true, outside);
  if (least == 1)
  {
    const unsigned int open = around->GetBufferPointer()[0];
    const auto         n = mask->GetLargestPossibleRegion().GetNumberOfPixels();
    std::transform(around->GetBufferPointer(),
                   around->GetBufferPointer() + n,
                   mask->GetBufferPointer(),
                   [open](unsigned int label) { return label != open; });
    outside = 1;
  }
  return mask;
}
} // namespace bone
