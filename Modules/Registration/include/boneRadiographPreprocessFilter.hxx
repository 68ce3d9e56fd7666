/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographPreprocessFilter_hxx
#define boneRadiographPreprocessFilter_hxx

#include "boneRadiographPreprocessFilter.h"

#include <itkImageRegionConstIterator.h>
#include <itkImageRegionIterator.h>

#include <stdexcept>

namespace bone
{
template <typename TInputImage, typename TOutputImage, typename TMaskImage>
RadiographPreprocessFilter<TInputImage, TOutputImage, TMaskImage>::RadiographPreprocessFilter()
{
  this->AddOptionalInputName("Mask");
  this->SetNumberOfRequiredOutputs(2);
  this->SetNthOutput(1, this->MakeOutput(1));
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
itk::ProcessObject::DataObjectPointer
RadiographPreprocessFilter<TInputImage, TOutputImage, TMaskImage>::MakeOutput(
  itk::ProcessObject::DataObjectPointerArraySizeType index)
{
  return index == 1 ? WeightImageType::New().GetPointer() : Superclass::MakeOutput(index);
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
auto
RadiographPreprocessFilter<TInputImage, TOutputImage, TMaskImage>::GetWeights() -> WeightImageType *
{
  return itkDynamicCastInDebugMode<WeightImageType *>(this->itk::ProcessObject::GetOutput(1));
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
void
RadiographPreprocessFilter<TInputImage, TOutputImage, TMaskImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
void
RadiographPreprocessFilter<TInputImage, TOutputImage, TMaskImage>::VerifyInputInformation() const
{
  const auto size = this->GetInput()->GetLargestPossibleRegion().GetSize();
  if (size[2] != 1 || size[0] == 0 || size[1] == 0)
  {
    itkExceptionMacro("The input is of " << size[0] << " x " << size[1] << " x " << size[2]
                                         << " pixels; a radiograph is columns x rows x 1.");
  }
  if (this->GetMask() != nullptr && this->GetMask()->GetLargestPossibleRegion().GetSize() != size)
  {
    const auto mask = this->GetMask()->GetLargestPossibleRegion().GetSize();
    itkExceptionMacro("The input 'Mask' is of " << mask[0] << " x " << mask[1] << " x " << mask[2]
                                                << " pixels and the radiograph of " << size[0] << " x " << size[1]
                                                << " x 1: draw the mask on the radiograph.");
  }
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
void
RadiographPreprocessFilter<TInputImage, TOutputImage, TMaskImage>::GenerateInputRequestedRegion()
{
  Superclass::GenerateInputRequestedRegion();
  const_cast<TInputImage *>(this->GetInput())->SetRequestedRegionToLargestPossibleRegion();
  if (this->GetMask() != nullptr)
  {
    const_cast<TMaskImage *>(this->GetMask())->SetRequestedRegionToLargestPossibleRegion();
  }
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
void
RadiographPreprocessFilter<TInputImage, TOutputImage, TMaskImage>::EnlargeOutputRequestedRegion(
  itk::DataObject * output)
{
  Superclass::EnlargeOutputRequestedRegion(output);
  output->SetRequestedRegionToLargestPossibleRegion();
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
void
RadiographPreprocessFilter<TInputImage, TOutputImage, TMaskImage>::GenerateData()
{
  this->AllocateOutputs();
  const TInputImage * input = this->GetInput();
  const auto &        region = input->GetLargestPossibleRegion();
  DetectorGrid        grid;
  for (unsigned int k = 0; k < 2; ++k)
  {
    grid.size[k] = static_cast<int>(region.GetSize(k));
    grid.spacing[k] = input->GetSpacing()[k];
  }
  std::vector<double> pixels;
  pixels.reserve(grid.Count());
  for (itk::ImageRegionConstIterator<TInputImage> it(input, region); !it.IsAtEnd(); ++it)
  {
    pixels.push_back(static_cast<double>(it.Get()));
  }
  std::vector<std::uint8_t> mask;
  if (const TMaskImage * image = this->GetMask())
  {
    mask.reserve(grid.Count());
    for (itk::ImageRegionConstIterator<TMaskImage> it(image, image->GetLargestPossibleRegion()); !it.IsAtEnd(); ++it)
    {
      mask.push_back(it.Get() != 0 ? 1 : 0);
    }
  }
  PreprocessedRadiograph result;
  try
  {
    result = PreprocessRadiograph(std::move(pixels), mask, grid, m_Parameters, Execution(this));
  }
  catch (const std::invalid_argument & reason)
  {
    itkExceptionMacro("" << reason.what());
  }
  m_Report = std::move(result.report);
  auto integral = result.integrals.begin();
  for (itk::ImageRegionIterator<TOutputImage> it(this->GetOutput(), region); !it.IsAtEnd(); ++it, ++integral)
  {
    it.Set(static_cast<typename TOutputImage::PixelType>(*integral));
  }
  auto weight = result.weights.begin();
  for (itk::ImageRegionIterator<WeightImageType> it(this->GetWeights(), region); !it.IsAtEnd(); ++it, ++weight)
  {
    it.Set(*weight);
  }
}

template <typename TInputImage, typename TOutputImage, typename TMaskImage>
void
RadiographPreprocessFilter<TInputImage, TOutputImage, TMaskImage>::PrintSelf(std::ostream & os,
                                                                             itk::Indent    indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "OpenBeam of the last run: " << m_Report.openBeam << '\n';
  os << indent << "UsedShare of the last run: " << m_Report.usedShare << '\n';
}
} // namespace bone

#endif
