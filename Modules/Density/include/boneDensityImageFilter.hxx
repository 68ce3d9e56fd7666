/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityImageFilter_hxx
#define boneDensityImageFilter_hxx

#include "boneDensityImageFilter.h"
#include "boneDensityRaster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace bone
{
template <typename TMesh, typename TOutputImage>
DensityImageFilter<TMesh, TOutputImage>::DensityImageFilter()
{
  this->SetPrimaryInputName("Mesh");
  this->AddOptionalInputName("ReferenceImage");
  m_Size.Fill(0);
  m_Origin.Fill(0.0);
  m_Spacing.Fill(1.0);
  m_Direction.SetIdentity();
}

template <typename TMesh, typename TOutputImage>
void
DensityImageFilter<TMesh, TOutputImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  if constexpr (std::is_integral_v<PixelType>)
  {
    this->VerifyParameters(); // real pixels may be NaN outside
  }
  if (this->GetReferenceImage() != nullptr)
  {
    return;
  }
  for (unsigned int axis = 0; axis < 3; ++axis)
  {
    if (m_Size[axis] == 0 || !(m_Spacing[axis] > 0))
    {
      itkExceptionMacro("Size is " << m_Size << " and Spacing " << m_Spacing
                                   << ": set a ReferenceImage, or a Size and a Spacing above 0.");
    }
  }
}

template <typename TMesh, typename TOutputImage>
void
DensityImageFilter<TMesh, TOutputImage>::GenerateOutputInformation()
{
  TOutputImage *             output = this->GetOutput();
  const ReferenceImageType * reference = this->GetReferenceImage();
  if (reference != nullptr)
  {
    output->CopyInformation(reference);
    return;
  }
  output->SetLargestPossibleRegion(typename TOutputImage::RegionType(m_Size));
  output->SetOrigin(m_Origin);
  output->SetSpacing(m_Spacing);
  output->SetDirection(m_Direction);
}

template <typename TMesh, typename TOutputImage>
void
DensityImageFilter<TMesh, TOutputImage>::GenerateInputRequestedRegion()
{
  // The whole mesh; of the reference image only its geometry.
  if (auto * mesh = const_cast<TMesh *>(this->GetInput()))
  {
    mesh->SetRequestedRegionToLargestPossibleRegion();
  }
}

template <typename TMesh, typename TOutputImage>
void
DensityImageFilter<TMesh, TOutputImage>::GenerateData()
{
  const Execution  execution(this);
  const MeshArrays arrays = this->GetInput()->GetArrays();
  if (!arrays.HasDensity())
  {
    itkExceptionMacro("The input 'Mesh' has no density: fit one first.");
  }
  this->AllocateOutputs();
  TOutputImage *      output = this->GetOutput();
  const auto          region = output->GetBufferedRegion();
  const VoxelGrid     grid = MakeVoxelGrid(*output, region);
  const DensityRaster raster(arrays, grid);
  const std::size_t   sliceSize = static_cast<std::size_t>(grid.size[0]) * grid.size[1];
  PixelType *         buffer = output->GetBufferPointer();

  execution.For(grid.size[2], [&](std::size_t k) {
    std::vector<double> values(sliceSize);
    raster.FillSlice(static_cast<int>(k), m_Parameters.outsideValue, values.data());
    std::transform(values.begin(), values.end(), buffer + k * sliceSize, [](double value) {
      if constexpr (std::is_integral<PixelType>::value)
      {
        value = std::min(std::max(std::round(value), static_cast<double>(std::numeric_limits<PixelType>::lowest())),
                         static_cast<double>(std::numeric_limits<PixelType>::max()));
      }
      return static_cast<PixelType>(value);
    });
  });
}

template <typename TMesh, typename TOutputImage>
void
DensityImageFilter<TMesh, TOutputImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Size: " << m_Size << '\n';
  os << indent << "Origin: " << m_Origin << '\n';
  os << indent << "Spacing: " << m_Spacing << '\n';
  os << indent << "Direction:\n" << m_Direction << '\n';
  PrintParameters(os, indent, m_Parameters);
}
} // namespace bone

#endif
