/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelCrop.h"

#include "boneLabelValue.h"

#include <itkImageRegionConstIteratorWithIndex.h>
#include <itkImageRegionIterator.h>
#include <itkRegionOfInterestImageFilter.h>

#include <algorithm>
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

/** "1 (8000 voxels, 8.0 cm^3), 2 (...)": the first twenty. */
std::string
ListLabels(const std::vector<LabelCount> & labels)
{
  constexpr std::size_t most = 20;
  std::ostringstream    list;
  list << std::fixed << std::setprecision(1);
  for (std::size_t i = 0; i < std::min(most, labels.size()); ++i)
  {
    list << (i == 0 ? "" : ", ") << labels[i].value << " (" << labels[i].voxels << " voxels, "
         << 1e-3 * labels[i].volume << " cm^3)";
  }
  list << (labels.size() > most ? ", ..." : "");
  return list.str();
}
} // namespace

std::vector<LabelCount>
CountLabels(const LabelImage * labels)
{
  constexpr int            offset = 32768;
  std::vector<std::size_t> counts(2 * offset, 0);
  for (itk::ImageRegionConstIterator<LabelImage> it(labels, labels->GetLargestPossibleRegion()); !it.IsAtEnd(); ++it)
  {
    ++counts[static_cast<std::size_t>(it.Get() + offset)];
  }
  const auto              spacing = labels->GetSpacing();
  std::vector<LabelCount> result;
  for (int value = -offset; value < offset; ++value)
  {
    const std::size_t voxels = counts[static_cast<std::size_t>(value + offset)];
    if (value != 0 && voxels > 0)
    {
      result.push_back({ value, voxels, static_cast<double>(voxels) * spacing[0] * spacing[1] * spacing[2] });
    }
  }
  return result;
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

void
VerifySameGrid(const CTImage * ct, const LabelImage * labels)
{
  const auto size = ct->GetLargestPossibleRegion().GetSize();
  const auto other = labels->GetLargestPossibleRegion().GetSize();
  if (size != other)
  {
    itkGenericExceptionMacro("The label map has " << other[0] << " x " << other[1] << " x " << other[2]
                                                  << " voxels, the CT " << size[0] << " x " << size[1] << " x "
                                                  << size[2] << ": resample it to the CT's grid.");
  }
  // Corners at the same place mean the same origin, spacing and direction.
  for (int corner = 0; corner < 4; ++corner)
  {
    CTImage::IndexType index = ct->GetLargestPossibleRegion().GetIndex();
    if (corner > 0)
    {
      index[corner - 1] += static_cast<itk::IndexValueType>(size[corner - 1]) - 1;
    }
    CTImage::PointType a;
    CTImage::PointType b;
    ct->TransformIndexToPhysicalPoint(index, a);
    labels->TransformIndexToPhysicalPoint(index, b);
    const double voxel = std::min({ ct->GetSpacing()[0], ct->GetSpacing()[1], ct->GetSpacing()[2] });
    if (!(a.EuclideanDistanceTo(b) < 1e-2 * voxel))
    {
      itkGenericExceptionMacro("The label map does not lie where the CT lies: a corner is "
                               << a.EuclideanDistanceTo(b) << " mm off. Resample it to the CT's grid.");
    }
  }
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

  std::size_t k = 0;
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
          const int  faces = (first || !IsLabel(buffer[k - strides[d]], label) ? 1 : 0) +
                            (last || !IsLabel(buffer[k + strides[d]], label) ? 1 : 0);
          extent.leavesImage = extent.leavesImage || first || last;
          extent.surface += faces * voxel / spacing[d] * 2.0 / 3.0;
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
    extent.region.SetIndex(d, whole.GetIndex(d) + lower[d]);
    extent.region.SetSize(d, static_cast<itk::SizeValueType>(upper[d] - lower[d] + 1));
  }
  return extent;
}

CTImage::RegionType
GrowRegion(const CTImage * image, const CTImage::RegionType & region, double margin)
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
  if (StatesOneBone(*image))
  {
    StateOneBone(*cropped);
  }
  return cropped;
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
