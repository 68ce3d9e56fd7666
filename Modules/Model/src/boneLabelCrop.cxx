/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelCrop.h"

#include "boneLabelValue.h"

#include <itkImageRegionConstIteratorWithIndex.h>
#include <itkImageRegionIterator.h>
#include <itkImageScanlineConstIterator.h>
#include <itkNearestNeighborInterpolateImageFunction.h>
#include <itkRegionOfInterestImageFilter.h>
#include <itkResampleImageFilter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
bool
IsLabel(short value, int label)
{
  return label == 0 ? value != 0 : value == label;
}

template <typename TImage>
typename TImage::Pointer
CropImage(const TImage * image, const CTImage::RegionType & region)
{
  auto filter = itk::RegionOfInterestImageFilter<TImage, TImage>::New();
  filter->SetInput(image);
  filter->SetRegionOfInterest(region);
  filter->Update();
  typename TImage::Pointer output = filter->GetOutput();
  output->DisconnectPipeline();
  return output;
}

using Corner = itk::Point<double, 3>;

/** The centres of the eight corner voxels. */
std::array<Corner, 8>
Corners(const itk::ImageBase<3> * image)
{
  const auto            region = image->GetLargestPossibleRegion();
  std::array<Corner, 8> corners;
  for (unsigned int i = 0; i < 8; ++i)
  {
    CTImage::IndexType index = region.GetIndex();
    for (unsigned int d = 0; d < 3; ++d)
    {
      index[d] += (i >> d & 1U) != 0 ? static_cast<itk::IndexValueType>(region.GetSize(d)) - 1 : 0;
    }
    image->TransformIndexToPhysicalPoint(index, corners[i]);
  }
  return corners;
}

double
LargestCornerDistance(const itk::ImageBase<3> * a, const itk::ImageBase<3> * b)
{
  const auto first = Corners(a);
  const auto second = Corners(b);
  double     largest = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i)
  {
    largest = std::max(largest, first[i].EuclideanDistanceTo(second[i]));
  }
  return largest;
}

double
SmallestEdge(const itk::ImageBase<3> * image)
{
  return std::min({ image->GetSpacing()[0], image->GetSpacing()[1], image->GetSpacing()[2] });
}

std::string
SizeText(const CTImage::SizeType & size)
{
  std::ostringstream text;
  text << size[0] << " x " << size[1] << " x " << size[2];
  return text.str();
}

/** "lies at x -100 to 50, y 0 to 30, z -900 to -700 mm" (LPS). */
std::string
PlaceText(const itk::ImageBase<3> * image)
{
  const auto         corners = Corners(image);
  std::ostringstream text;
  text << "lies at";
  for (unsigned int d = 0; d < 3; ++d)
  {
    const auto less = [d](const Corner & a, const Corner & b) { return a[d] < b[d]; };
    const auto [least, most] = std::minmax_element(corners.begin(), corners.end(), less);
    text << (d == 0 ? " " : ", ") << "xyz"[d] << ' ' << (*least)[d] << " to " << (*most)[d];
  }
  text << " mm";
  return text.str();
}

void
CopyStatement(const LabelImage * from, LabelImage * to)
{
  if (StatesOneBone(*from))
  {
    StateOneBone(*to);
  }
}

/** How often a value occurs, and between which voxels. */
struct ValueExtent
{
  std::size_t        voxels{ 0 };
  CTImage::IndexType lower{ { 0, 0, 0 } };
  CTImage::IndexType upper{ { 0, 0, 0 } };

  void
  Add(const CTImage::IndexType & first, std::size_t run)
  {
    CTImage::IndexType last = first;
    last[0] += static_cast<itk::IndexValueType>(run) - 1;
    for (unsigned int d = 0; d < 3; ++d)
    {
      lower[d] = voxels == 0 ? first[d] : std::min(lower[d], first[d]);
      upper[d] = voxels == 0 ? last[d] : std::max(upper[d], last[d]);
    }
    voxels += run;
  }
};

constexpr int LabelOffset = 32768;

/** Counts the runs of one value in the rows of a region that is buffered. */
void
CountRuns(const LabelImage * labels, const CTImage::RegionType & region, std::vector<ValueExtent> & extents)
{
  const auto length = static_cast<std::size_t>(region.GetSize(0));
  for (itk::ImageScanlineConstIterator<LabelImage> it(labels, region); !it.IsAtEnd(); it.NextLine())
  {
    const CTImage::IndexType start = it.GetIndex();
    const short *            row = labels->GetBufferPointer() + labels->ComputeOffset(start);
    for (std::size_t x = 0; x < length;)
    {
      std::size_t end = x + 1;
      for (; end < length && row[end] == row[x]; ++end)
      {}
      if (row[x] != 0)
      {
        CTImage::IndexType first = start;
        first[0] += static_cast<itk::IndexValueType>(x);
        extents[static_cast<std::size_t>(row[x] + LabelOffset)].Add(first, end - x);
      }
      x = end;
    }
  }
}
} // namespace

std::vector<LabelCount>
CountLabels(const LabelImage * labels)
{
  constexpr std::size_t    slabVoxels = std::size_t{ 1 } << 22;
  std::vector<ValueExtent> extents(2 * LabelOffset);
  const auto               whole = labels->GetLargestPossibleRegion();
  const std::size_t        slice = std::max<std::size_t>(1, whole.GetSize(0) * whole.GetSize(1));
  const std::size_t        thickness = std::max<std::size_t>(1, slabVoxels / slice);
  for (std::size_t z = 0; z < whole.GetSize(2); z += thickness)
  {
    CTImage::RegionType slab = whole;
    slab.SetIndex(2, whole.GetIndex(2) + static_cast<itk::IndexValueType>(z));
    slab.SetSize(2, std::min<itk::SizeValueType>(thickness, whole.GetSize(2) - z));
    if (labels->GetSource())
    {
      auto * image = const_cast<LabelImage *>(labels);
      image->SetRequestedRegion(slab);
      image->Update();
    }
    CountRuns(labels, slab, extents);
  }
  const auto              spacing = labels->GetSpacing();
  std::vector<LabelCount> result;
  for (int value = -LabelOffset; value < LabelOffset; ++value)
  {
    const ValueExtent & extent = extents[static_cast<std::size_t>(value + LabelOffset)];
    if (extent.voxels > 0)
    {
      LabelCount count{ value, extent.voxels };
      count.volume = static_cast<double>(extent.voxels) * spacing[0] * spacing[1] * spacing[2];
      count.region.SetIndex(extent.lower);
      count.region.SetUpperIndex(extent.upper);
      result.push_back(count);
    }
  }
  return result;
}

std::string
ListLabels(const std::vector<LabelCount> & labels)
{
  constexpr std::size_t most = 20;
  std::ostringstream    list;
  list << std::fixed << std::setprecision(1);
  for (std::size_t i = 0; i < std::min(most, labels.size()); ++i)
  {
    list << (i == 0 ? "" : ", ") << labels[i].value;
    if (!labels[i].name.empty())
    {
      list << " '" << labels[i].name << '\'';
    }
    list << " (" << labels[i].voxels << " voxels, " << 1e-3 * labels[i].volume << " cm^3)";
  }
  list << (labels.size() > most ? ", ..." : "");
  return list.str();
}

void
VerifyOneBone(const LabelImage * labels, int label)
{
  if (label != 0 || StatesOneBone(*labels))
  {
    return;
  }
  const auto counts = CountLabels(labels);
  if (counts.size() > 1)
  {
    itkGenericExceptionMacro("The label map has " << counts.size() << " labels, and which of them is the bone was not "
                                                  << "said: " << ListLabels(counts) << '.');
  }
}

bool
IsSameGrid(const itk::ImageBase<3> * a, const itk::ImageBase<3> * b)
{
  return a->GetLargestPossibleRegion() == b->GetLargestPossibleRegion() &&
         LargestCornerDistance(a, b) < GridTolerance * SmallestEdge(a);
}

LabelImage::Pointer
PutOnGrid(const LabelImage * labels, const itk::ImageBase<3> * ct)
{
  const auto size = ct->GetLargestPossibleRegion().GetSize();
  const auto other = labels->GetLargestPossibleRegion().GetSize();
  if (size != other)
  {
    itkGenericExceptionMacro("The label map has " << SizeText(other) << " voxels, the CT " << SizeText(size)
                                                  << ": resample it to the CT's grid.");
  }
  if (!IsSameGrid(ct, labels))
  {
    itkGenericExceptionMacro("The label map does not lie where the CT lies: a corner is "
                             << LargestCornerDistance(ct, labels) << " mm off. Resample it to the CT's grid.");
  }
  auto image = LabelImage::New();
  image->Graft(labels);
  image->CopyInformation(ct);
  CopyStatement(labels, image);
  return image;
}

LabelImage::Pointer
ResampleToGrid(const LabelImage * labels, const itk::ImageBase<3> * ct)
{
  for (const auto & corner : Corners(ct))
  {
    const auto index = labels->TransformPhysicalPointToContinuousIndex<double>(corner);
    for (unsigned int d = 0; d < 3; ++d)
    {
      const auto   region = labels->GetLargestPossibleRegion();
      const double first = static_cast<double>(region.GetIndex(d)) - 0.5;
      if (!(index[d] >= first - GridTolerance &&
            index[d] <= first + static_cast<double>(region.GetSize(d)) + GridTolerance))
      {
        itkGenericExceptionMacro("The label map does not cover the CT: it "
                                 << PlaceText(labels) << ", where the CT " << PlaceText(ct)
                                 << ". Crop the CT to what the label map covers, or give the label map of this CT");
      }
    }
  }
  using Nearest = itk::NearestNeighborInterpolateImageFunction<LabelImage>;
  auto filter = itk::ResampleImageFilter<LabelImage, LabelImage>::New();
  filter->SetInput(labels);
  filter->SetInterpolator(Nearest::New());
  filter->SetSize(ct->GetLargestPossibleRegion().GetSize());
  filter->SetOutputStartIndex(ct->GetLargestPossibleRegion().GetIndex());
  filter->SetOutputOrigin(ct->GetOrigin());
  filter->SetOutputSpacing(ct->GetSpacing());
  filter->SetOutputDirection(ct->GetDirection());
  filter->Update();
  LabelImage::Pointer image = filter->GetOutput();
  image->DisconnectPipeline();
  CopyStatement(labels, image);
  return image;
}

BoneExtent
MeasureLabel(const LabelImage * labels, int label)
{
  const auto          whole = labels->GetLargestPossibleRegion();
  const auto          size = whole.GetSize();
  const auto          spacing = labels->GetSpacing();
  const double        voxel = spacing[0] * spacing[1] * spacing[2];
  const short *       buffer = labels->GetBufferPointer();
  const std::size_t   strides[3] = { 1, size[0], size[0] * size[1] };
  std::array<long, 3> lower{ { static_cast<long>(size[0]), static_cast<long>(size[1]), static_cast<long>(size[2]) } };
  std::array<long, 3> upper{ { -1, -1, -1 } };
  BoneExtent          extent;

  std::array<std::size_t, 3> faces{ { 0, 0, 0 } };
  std::size_t                k = 0;
  for (std::size_t z = 0; z < size[2]; ++z)
  {
    for (std::size_t y = 0; y < size[1]; ++y)
    {
      for (std::size_t x = 0; x < size[0]; ++x, ++k)
      {
        if (!IsLabel(buffer[k], label))
        {
          continue;
        }
        ++extent.voxels;
        const std::array<std::size_t, 3> index{ { x, y, z } };
        for (int d = 0; d < 3; ++d)
        {
          lower[d] = std::min(lower[d], static_cast<long>(index[d]));
          upper[d] = std::max(upper[d], static_cast<long>(index[d]));
          const bool first = index[d] == 0;
          const bool last = index[d] + 1 == size[d];
          faces[d] += first || !IsLabel(buffer[k - strides[d]], label) ? 1 : 0;
          faces[d] += last || !IsLabel(buffer[k + strides[d]], label) ? 1 : 0;
          extent.leavesImage = extent.leavesImage || first || last;
        }
      }
    }
  }
  if (extent.voxels == 0)
  {
    const auto counts = CountLabels(labels);
    itkGenericExceptionMacro("The label map has no voxel of "
                             << (label == 0 ? "any label" : "label " + std::to_string(label)) << "; "
                             << (counts.empty() ? "it is 0 everywhere" : "it has " + ListLabels(counts)) << '.');
  }
  extent.volume = static_cast<double>(extent.voxels) * voxel;
  for (int d = 0; d < 3; ++d)
  {
    extent.surface += static_cast<double>(faces[d]) * voxel / spacing[d] * 2.0 / 3.0;
    extent.region.SetIndex(d, whole.GetIndex(d) + lower[d]);
    extent.region.SetSize(d, static_cast<itk::SizeValueType>(upper[d] - lower[d] + 1));
  }
  return extent;
}

CTImage::RegionType
GrowRegion(const itk::ImageBase<3> * image, const CTImage::RegionType & region, double margin)
{
  CTImage::RegionType grown = region;
  CTImage::SizeType   radius;
  for (unsigned int d = 0; d < 3; ++d)
  {
    radius[d] = static_cast<itk::SizeValueType>(std::ceil(margin / image->GetSpacing()[d]));
  }
  grown.PadByRadius(radius);
  grown.Crop(image->GetLargestPossibleRegion());
  return grown;
}

CTImage::Pointer
Crop(const CTImage * image, const CTImage::RegionType & region)
{
  return CropImage(image, region);
}

LabelImage::Pointer
Crop(const LabelImage * image, const CTImage::RegionType & region)
{
  const auto cropped = CropImage(image, region);
  CopyStatement(image, cropped);
  return cropped;
}

void
RemoveOtherLabels(int label, LabelImage * labels)
{
  short * const first = labels->GetBufferPointer();
  std::replace_if(
    first,
    first + labels->GetBufferedRegion().GetNumberOfPixels(),
    [label](short value) { return !IsLabel(value, label); },
    short{ 0 });
}

LabelImage::Pointer
MaskOfLabel(const LabelImage * labels, int label)
{
  auto mask = LabelImage::New();
  mask->CopyInformation(labels);
  mask->SetRegions(labels->GetLargestPossibleRegion());
  mask->Allocate();
  itk::ImageRegionConstIterator<LabelImage> from(labels, labels->GetLargestPossibleRegion());
  itk::ImageRegionIterator<LabelImage>      to(mask, labels->GetLargestPossibleRegion());
  for (; !from.IsAtEnd(); ++from, ++to)
  {
    to.Set(IsLabel(from.Get(), label) ? 1 : 0);
  }
  return mask;
}
} // namespace bone
