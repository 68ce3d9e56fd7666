/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneVoxelDRRImageFilter_hxx
#define boneVoxelDRRImageFilter_hxx

#include "boneVoxelDRRImageFilter.h"

#include <itkImageRegionConstIteratorWithIndex.h>

#include <algorithm>

namespace bone
{
template <typename TInputImage, typename TOutputImage, typename TMaskImage>
VoxelDRRImageFilter<TInputImage, TOutputImage, TMaskImage>::VoxelDRRImageFilter()
{
  this->SetPrimaryInputName("Image");
  this->AddOptionalInputName("Mask");
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
void
VoxelDRRImageFilter<TInputImage, TOutputImage, TMaskImage>::VerifyInputInformation() const
{
  Superclass::VerifyInputInformation();
  const TInputImage * image = this->GetInput();
  const TMaskImage *  mask = this->GetMask();
  if (mask == nullptr)
  {
    return;
  }
  constexpr double tolerance = 1e-4; // of a voxel, and of a direction's components
  const auto &     spacing = image->GetSpacing();
  const double     length = spacing.GetVnlVector().min_value() * tolerance;
  if (mask->GetLargestPossibleRegion() != image->GetLargestPossibleRegion() ||
      !mask->GetOrigin().GetVnlVector().is_equal(image->GetOrigin().GetVnlVector(), length) ||
      !mask->GetSpacing().GetVnlVector().is_equal(spacing.GetVnlVector(), length) ||
      !mask->GetDirection().GetVnlMatrix().is_equal(image->GetDirection().GetVnlMatrix(), tolerance))
  {
    itkExceptionMacro(
      "The inputs 'Mask' and 'Image' lie on different grids (region, origin, spacing or direction): resample "
      "the mask to the image.");
  }
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
auto
VoxelDRRImageFilter<TInputImage, TOutputImage, TMaskImage>::FindRegion() const -> RegionType
{
  RegionType         region = this->GetInput()->GetLargestPossibleRegion();
  const TMaskImage * mask = this->GetMask();
  if (mask == nullptr)
  {
    return region;
  }
  auto lower = region.GetUpperIndex(), upper = region.GetIndex();
  bool found = false;
  for (itk::ImageRegionConstIteratorWithIndex<TMaskImage> it(mask, region); !it.IsAtEnd(); ++it)
  {
    if (this->IsMasked(it.Get()))
    {
      found = true;
      for (unsigned int k = 0; k < 3; ++k)
      {
        lower[k] = std::min(lower[k], it.GetIndex()[k]);
        upper[k] = std::max(upper[k], it.GetIndex()[k]);
      }
    }
  }
  if (!found)
  {
    const int label = m_Parameters.maskLabel;
    itkExceptionMacro("No voxel of the input 'Mask' has "
                      << (label == 0 ? std::string("a label") : "the label " + std::to_string(label))
                      << ": choose one that it has.");
  }
  RegionType counted;
  counted.SetIndex(lower);
  counted.SetUpperIndex(upper);
  counted.PadByRadius(1);
  counted.Crop(region);
  return counted;
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
VoxelVolume
VoxelDRRImageFilter<TInputImage, TOutputImage, TMaskImage>::CopyGrid(const RegionType & region,
                                                                     const Execution &  execution) const
{
  const TInputImage *                     image = this->GetInput();
  const TMaskImage *                      mask = this->GetMask();
  typename TInputImage::PointType         origin;
  const typename TInputImage::SpacingType spacing = image->GetSpacing();
  image->TransformIndexToPhysicalPoint(region.GetIndex(), origin);

  VoxelVolume grid;
  for (int k = 0; k < 3; ++k)
  {
    grid.size[k] = static_cast<int>(region.GetSize(k));
    grid.origin[k] = origin[k];
    for (int axis = 0; axis < 3; ++axis)
    {
      grid.axes(k, axis) = image->GetDirection()(k, axis) * spacing[axis];
    }
  }
  grid.values.resize(region.GetNumberOfPixels());
  const auto   curve = this->GetCurve();
  const bool   aboveAir = m_Parameters.aboveAir && curve.huToAttenuation == HUToAttenuation::None;
  const auto   valueOf = [&](double hu) { return aboveAir ? std::max(0.0, hu + 1000.0) : curve.At(hu); };
  const auto   rows = static_cast<std::size_t>(grid.size[1]);
  const auto   slice = rows * grid.size[0];
  const auto & first = region.GetIndex();
  execution.For(grid.size[2], [&](std::size_t z) {
    for (std::size_t y = 0; y < rows; ++y)
    {
      typename TInputImage::IndexType index = {
        { first[0], first[1] + static_cast<itk::IndexValueType>(y), first[2] + static_cast<itk::IndexValueType>(z) }
      };

      const auto * from = image->GetBufferPointer() + image->ComputeOffset(index);
      const auto * label = mask == nullptr ? nullptr : mask->GetBufferPointer() + mask->ComputeOffset(index);
      float *      to = grid.values.data() + z * slice + y * grid.size[0];
      for (int x = 0; x < grid.size[0]; ++x)
      {
        const bool counts = label == nullptr || this->IsMasked(label[x]);
        to[x] = counts ? static_cast<float>(valueOf(from[x])) : 0.0f;
      }
    }
  });
  return grid;
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
void
VoxelDRRImageFilter<TInputImage, TOutputImage, TMaskImage>::ComputeIntegrals(
  const std::vector<XRayGeometry::View> & views,
  const Execution &                       execution,
  const std::vector<float *> &            integrals)
{
  const VoxelVolume grid = this->CopyGrid(this->FindRegion(), execution.Part(0.0, 0.1));
  const Execution   main = execution.Part(0.1, 1.0);
  const auto        count = static_cast<double>(views.size());
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    ProjectVoxels(
      grid, views[i], main.Part(static_cast<double>(i) / count, static_cast<double>(i + 1) / count), integrals[i]);
  }
}
} // namespace bone

#endif
