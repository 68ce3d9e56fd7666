/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourImage.h"

#include "boneLabelValue.h"
#include "bonePolylines.h"
#include "boneRefuse.h"

#include <itkContourExtractor2DImageFilter.h>
#include <itkImageRegionConstIteratorWithIndex.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
Vector3
ToVector(const itk::ImageBase<3>::PointType & p)
{
  return { p[0], p[1], p[2] };
}

// A line of voxels in space: voxel i is centred at start + i * step.
struct VoxelRow
{
  Vector3     start;
  Vector3     step;
  std::size_t count;
};

struct FlatContour
{
  std::vector<Vector2>  points;
  LabelImage::PixelType value;
  double                area;
};

class Rasterizer
{
public:
  explicit Rasterizer(const ContourStack & stack)
    : m_Stack(stack)
  {
    for (std::size_t k = 0; k < stack.GetSlices().size(); ++k)
    {
      std::vector<FlatContour> contours;
      for (const Contour & contour : stack.GetSlices()[k].contours)
      {
        if (!contour.axis)
        {
          FlatContour flat;
          for (const Vector3 & p : contour.points)
          {
            flat.points.push_back(stack.ToPlane(p));
          }
          flat.value = static_cast<LabelImage::PixelType>(contour.region);
          flat.area = std::abs(SignedArea(flat.points));
          contours.push_back(std::move(flat));
        }
      }
      // What lies inside another is painted after it.
      std::stable_sort(
        contours.begin(), contours.end(), [](const auto & a, const auto & b) { return a.area > b.area; });
      m_Contours.push_back(std::move(contours));
    }
  }

  // Paints a row; `values` has its voxels, `stride` apart.
  void
  Paint(const VoxelRow & row, LabelImage::PixelType * values, std::ptrdiff_t stride) const
  {
    const Vector2 q = m_Stack.ToPlane(row.start);
    const Vector2 d = m_Stack.ToPlane(row.step);
    const double  climb = row.step.dot(m_Stack.GetNormal());
    const double  height = row.start.dot(m_Stack.GetNormal());
    std::size_t   i = 0;
    while (i < row.count)
    {
      const int   slice = this->NearestSlice(height + static_cast<double>(i) * climb);
      std::size_t end = std::abs(climb) > 1e-12 ? i + 1 : row.count;
      while (end < row.count && this->NearestSlice(height + static_cast<double>(end) * climb) == slice)
      {
        ++end;
      }
      if (slice >= 0)
      {
        for (const FlatContour & contour : m_Contours[static_cast<std::size_t>(slice)])
        {
          PaintRun(contour, q, d, i, end, values, stride);
        }
      }
      i = end;
    }
  }

private:
  int
  NearestSlice(double height) const
  {
    const std::size_t n = m_Stack.GetSlices().size();
    int               best = -1;
    double            least = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < n; ++k)
    {
      const double off = std::abs(m_Stack.GetHeight(k) - height);
      if (off < least)
      {
        least = off;
        best = static_cast<int>(k);
      }
    }
    if (n < 2)
    {
      return least <= 0.5 ? best : -1; // the only slice there is takes what is within half a millimetre
    }
    // Beyond the first and the last slice, half the distance to the next one.
    const bool   below = height < m_Stack.GetHeight(0);
    const bool   above = height > m_Stack.GetHeight(n - 1);
    const double step =
      below ? m_Stack.GetHeight(1) - m_Stack.GetHeight(0) : m_Stack.GetHeight(n - 1) - m_Stack.GetHeight(n - 2);
    return (!below && !above) || least <= 0.5 * step + 1e-6 ? best : -1;
  }

  // Voxels first .. last - 1 of the line q + i d that lie inside the contour.
  static void
  PaintRun(const FlatContour &     contour,
           const Vector2 &         q,
           const Vector2 &         d,
           std::size_t             first,
           std::size_t             last,
           LabelImage::PixelType * values,
           std::ptrdiff_t          stride)
  {
    std::vector<double> crossings;
    const std::size_t   n = contour.points.size();
    for (std::size_t e = 0; e < n; ++e)
    {
      const Vector2 a = contour.points[e] - q;
      const Vector2 b = contour.points[(e + 1) % n] - q;
      const double  sideA = d.x() * a.y() - d.y() * a.x();
      const double  sideB = d.x() * b.y() - d.y() * b.x();
      if ((sideA > 0.0) != (sideB > 0.0))
      {
        const Vector2 crossing = a + sideA / (sideA - sideB) * (b - a);
        crossings.push_back(crossing.dot(d) / d.squaredNorm());
      }
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t c = 0; c + 1 < crossings.size(); c += 2)
    {
      const double from = std::max(std::ceil(crossings[c]), static_cast<double>(first));
      const double to = std::min(std::ceil(crossings[c + 1]), static_cast<double>(last));
      for (double i = from; i < to; ++i)
      {
        values[static_cast<std::ptrdiff_t>(i) * stride] = contour.value;
      }
    }
  }

  const ContourStack &                  m_Stack;
  std::vector<std::vector<FlatContour>> m_Contours;
};

// A slice of the label with a margin of one pixel.
itk::Image<float, 2>::Pointer
SliceOfLabel(const LabelImage * labels, int label, const LabelImage::IndexType & first, unsigned int axis)
{
  using Slice = itk::Image<float, 2>;
  const unsigned int a = (axis + 1) % 3, b = (axis + 2) % 3;
  const auto         region = labels->GetBufferedRegion();
  auto               slice = Slice::New();
  slice->SetRegions(Slice::RegionType({ { -1, -1 } }, { { region.GetSize(a) + 2, region.GetSize(b) + 2 } }));
  slice->Allocate(true);
  for (itk::IndexValueType j = 0; j < static_cast<itk::IndexValueType>(region.GetSize(b)); ++j)
  {
    for (itk::IndexValueType i = 0; i < static_cast<itk::IndexValueType>(region.GetSize(a)); ++i)
    {
      auto index = first;
      index[a] += i;
      index[b] += j;
      const auto value = labels->GetPixel(index);
      slice->SetPixel({ { i, j } }, (label != 0 ? value == label : value != 0) ? 1.0F : 0.0F);
    }
  }
  return slice;
}
} // namespace

LabelImage::Pointer
RasterizeContours(const ContourStack * stack, const itk::ImageBase<3> * grid)
{
  auto image = LabelImage::New();
  StateOneBone(*image);
  image->CopyInformation(grid);
  image->SetRegions(grid->GetLargestPossibleRegion());
  image->Allocate(true);
  if (stack->GetSlices().empty())
  {
    return image;
  }
  const auto region = image->GetBufferedRegion();
  const auto origin = region.GetIndex();
  const auto at = [&](const LabelImage::IndexType & index) {
    LabelImage::PointType point;
    image->TransformIndexToPhysicalPoint(index, point);
    return ToVector(point);
  };
  Vector3      steps[3];
  unsigned int along = 0; // rows follow the axis that lies best in the slices
  for (unsigned int a = 0; a < 3; ++a)
  {
    auto next = origin;
    ++next[a];
    steps[a] = at(next) - at(origin);
    const auto slope = [&](unsigned int axis) { return std::abs(steps[axis].normalized().dot(stack->GetNormal())); };
    along = slope(a) < slope(along) - 1e-9 ? a : along;
  }
  const unsigned int    b = (along + 1) % 3, c = (along + 2) % 3;
  const Rasterizer      rasterizer(*stack);
  const auto *          strides = image->GetOffsetTable();
  LabelImage::IndexType index = origin;
  for (itk::SizeValueType k = 0; k < region.GetSize(c); ++k)
  {
    for (itk::SizeValueType j = 0; j < region.GetSize(b); ++j)
    {
      index[b] = origin[b] + static_cast<itk::IndexValueType>(j);
      index[c] = origin[c] + static_cast<itk::IndexValueType>(k);
      rasterizer.Paint({ at(index), steps[along], region.GetSize(along) },
                       image->GetBufferPointer() + image->ComputeOffset(index),
                       strides[along]);
    }
  }
  return image;
}

ContourStack::Pointer
TraceLabels(const LabelImage * labels, int label, unsigned int axis)
{
  const auto            region = labels->GetBufferedRegion();
  const unsigned int    a = (axis + 1) % 3, b = (axis + 2) % 3;
  std::vector<Polyline> polylines;
  for (itk::SizeValueType k = 0; k < region.GetSize(axis); ++k)
  {
    auto first = region.GetIndex();
    first[axis] += static_cast<itk::IndexValueType>(k);
    const auto slice = SliceOfLabel(labels, label, first, axis);
    auto       extractor = itk::ContourExtractor2DImageFilter<itk::Image<float, 2>>::New();
    extractor->SetInput(slice);
    extractor->SetContourValue(0.5);
    extractor->Update();
    for (unsigned int c = 0; c < extractor->GetNumberOfOutputs(); ++c)
    {
      Polyline polyline;
      polyline.slice = static_cast<int>(k);
      const auto * path = extractor->GetOutput(c)->GetVertexList();
      for (unsigned int i = 0; i + 1 < path->Size(); ++i) // the last repeats the first
      {
        itk::ContinuousIndex<double, 3> index;
        index[axis] = static_cast<double>(first[axis]);
        index[a] = static_cast<double>(first[a]) + path->ElementAt(i)[0];
        index[b] = static_cast<double>(first[b]) + path->ElementAt(i)[1];
        LabelImage::PointType point;
        labels->TransformContinuousIndexToPhysicalPoint(index, point);
        polyline.contour.points.push_back(ToVector(point));
      }
      polylines.push_back(std::move(polyline));
    }
  }
  if (polylines.empty())
  {
    Refuse("no voxel of the label map ", label != 0 ? Say("is ", label) : std::string("differs from 0"));
  }
  const auto & direction = labels->GetDirection();
  return StackPolylines(
    std::move(polylines), { direction[0][axis], direction[1][axis], direction[2][axis] }, Vector3::Zero());
}
} // namespace bone
