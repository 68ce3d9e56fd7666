/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOwnOrientation.h"

#include <itkFlipImageFilter.h>
#include <itkImageRegionConstIterator.h>

#include <cmath>
#include <vector>

namespace bone
{
namespace
{
/** -1, 0 or 1 as the third central moment of weights along a line. Turned round, the line has exactly the opposite sign
 * but for the order of sums, which is what the tolerance is for. */
int
SignOfSkewness(const std::vector<double> & weights)
{
  constexpr double tolerance = 1e-9;
  double           total = 0.0, first = 0.0, third = 0.0, magnitude = 0.0;
  const double     last = static_cast<double>(weights.size()) - 1.0;
  for (std::size_t i = 0; i < weights.size(); ++i)
  {
    total += weights[i];
    first += weights[i] * (2.0 * static_cast<double>(i) - last); // twice the distance from the middle
  }
  for (std::size_t i = 0; i < weights.size() && total != 0.0; ++i)
  {
    const double term = weights[i] * std::pow(2.0 * static_cast<double>(i) - last - first / total, 3.0);
    third += term;
    magnitude += std::abs(term);
  }
  return std::abs(third) > tolerance * magnitude ? (third > 0.0 ? 1 : -1) : 0;
}

/** Sums over the mask's voxels in each slice along each axis. */
struct Profiles
{
  std::array<std::vector<double>, 3> voxels;
  std::array<std::vector<double>, 3> values;
};

Profiles
MeasureProfiles(const CTImage * ct, const LabelImage * mask)
{
  const auto region = mask->GetLargestPossibleRegion();
  Profiles   profiles;
  for (unsigned int d = 0; d < 3; ++d)
  {
    profiles.voxels[d].resize(region.GetSize(d));
    profiles.values[d].resize(region.GetSize(d));
  }
  itk::ImageRegionConstIterator<LabelImage> inside(mask, region);
  itk::ImageRegionConstIterator<CTImage>    value(ct, ct->GetLargestPossibleRegion());
  for (std::size_t z = 0; z < region.GetSize(2); ++z)
  {
    for (std::size_t y = 0; y < region.GetSize(1); ++y)
    {
      for (std::size_t x = 0; x < region.GetSize(0); ++x, ++inside, ++value)
      {
        const std::array<std::size_t, 3> index{ { x, y, z } };
        for (unsigned int d = 0; d < 3 && inside.Get() != 0; ++d)
        {
          profiles.voxels[d][index[d]] += 1.0;
          profiles.values[d][index[d]] += value.Get();
        }
      }
    }
  }
  return profiles;
}

template <typename TImage>
typename TImage::Pointer
FlipImage(const typename TImage::Pointer & image, const std::array<bool, 3> & axes)
{
  using FilterType = itk::FlipImageFilter<TImage>;
  typename FilterType::FlipAxesArrayType flipped;
  auto                                   corner = image->GetLargestPossibleRegion().GetIndex();
  auto                                   direction = image->GetDirection();
  bool                                   any = false;
  for (unsigned int d = 0; d < 3; ++d)
  {
    flipped[d] = axes[d];
    any = any || axes[d];
    corner[d] = axes[d] ? image->GetLargestPossibleRegion().GetUpperIndex()[d] : corner[d];
    for (unsigned int row = 0; row < 3; ++row)
    {
      direction[row][d] *= axes[d] ? -1.0 : 1.0;
    }
  }
  if (!any)
  {
    return image;
  }
  typename TImage::PointType origin;
  image->TransformIndexToPhysicalPoint(corner, origin);
  auto filter = FilterType::New();
  filter->SetInput(image);
  filter->SetFlipAxes(flipped);
  filter->Update();
  typename TImage::Pointer turned = filter->GetOutput();
  turned->DisconnectPipeline();
  typename TImage::RegionType region = turned->GetLargestPossibleRegion();
  region.SetIndex({ { 0, 0, 0 } });
  turned->SetRegions(region);
  turned->SetOrigin(origin);
  turned->SetDirection(direction);
  turned->SetMetaDataDictionary(image->GetMetaDataDictionary());
  return turned;
}

template <typename TImage>
typename TImage::Pointer
WithoutPlacement(const TImage * image)
{
  if (image == nullptr)
  {
    return nullptr;
  }
  const_cast<TImage *>(image)->Update(); // it may come from a source
  auto own = TImage::New();
  own->Graft(image);
  typename TImage::RegionType region = image->GetLargestPossibleRegion();
  region.SetIndex({ { 0, 0, 0 } });
  own->SetRegions(region);
  own->SetOrigin(typename TImage::PointType(0.0));
  typename TImage::DirectionType direction;
  direction.SetIdentity();
  own->SetDirection(direction);
  return own;
}
} // namespace

std::array<bool, 3>
FindFlips(const CTImage * ct, const LabelImage * mask)
{
  const Profiles      profiles = MeasureProfiles(ct, mask);
  std::array<bool, 3> flips{};
  for (unsigned int d = 0; d < 3; ++d)
  {
    const int sign = SignOfSkewness(profiles.voxels[d]);
    flips[d] = (sign != 0 ? sign : SignOfSkewness(profiles.values[d])) < 0;
  }
  return flips;
}

CTImage::Pointer
Flip(const CTImage::Pointer & image, const std::array<bool, 3> & axes)
{
  return FlipImage<CTImage>(image, axes);
}

LabelImage::Pointer
Flip(const LabelImage::Pointer & image, const std::array<bool, 3> & axes)
{
  return FlipImage<LabelImage>(image, axes);
}

CTImage::Pointer
OnOwnGrid(const CTImage * image)
{
  return WithoutPlacement(image);
}

LabelImage::Pointer
OnOwnGrid(const LabelImage * image)
{
  return WithoutPlacement(image);
}
} // namespace bone
