/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourStackFilter_hxx
#define boneContourStackFilter_hxx

#include "boneContourStackFilter.h"

#include <itkMultiThreaderBase.h>

#include <cmath>
#include <numeric>

namespace bone
{
template <typename TContourStack>
ContourStackFilter<TContourStack>::ContourStackFilter()
{
  this->SetNumberOfRequiredInputs(1);
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TContourStack>
itk::DataObject::Pointer
ContourStackFilter<TContourStack>::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType)
{
  return TContourStack::New().GetPointer();
}

template <typename TContourStack>
void
ContourStackFilter<TContourStack>::SetInput(const TContourStack * contours)
{
  this->SetNthInput(0, const_cast<TContourStack *>(contours));
}

template <typename TContourStack>
const TContourStack *
ContourStackFilter<TContourStack>::GetInput() const
{
  return itkDynamicCastInDebugMode<const TContourStack *>(this->GetPrimaryInput());
}

template <typename TContourStack>
TContourStack *
ContourStackFilter<TContourStack>::GetOutput()
{
  return itkDynamicCastInDebugMode<TContourStack *>(this->GetPrimaryOutput());
}

template <typename TContourStack>
const TContourStack *
ContourStackFilter<TContourStack>::GetOutput() const
{
  return itkDynamicCastInDebugMode<const TContourStack *>(this->GetPrimaryOutput());
}

template <typename TContourStack>
void
ContourStackFilter<TContourStack>::CheckParameter(const char * name, double value, bool zeroAllowed) const
{
  if (!(zeroAllowed ? value >= 0.0 : value > 0.0) || !std::isfinite(value))
  {
    itkExceptionMacro("" << name << " is " << value << "; it must be " << (zeroAllowed ? "0 or more." : "positive."));
  }
}

template <typename TContourStack>
std::vector<std::size_t>
ContourStackFilter<TContourStack>::ChooseSlices(const TContourStack & input)
{
  std::vector<std::size_t> all(input.GetSlices().size());
  std::iota(all.begin(), all.end(), std::size_t{ 0 });
  return all;
}

template <typename TContourStack>
void
ContourStackFilter<TContourStack>::GenerateData()
{
  const TContourStack * input = this->GetInput();
  if (input->GetNumberOfContours() == 0)
  {
    itkExceptionMacro("The input stack holds no contour.");
  }
  input->Verify();
  this->GetMultiThreader()->SetNumberOfWorkUnits(this->GetNumberOfWorkUnits());
  const std::vector<std::size_t> chosen = this->ChooseSlices(*input);
  ContourStack::SliceContainer   slices(chosen.size());
  this->GetMultiThreader()->ParallelizeArray(
    0,
    slices.size(),
    [this, input, &slices, &chosen](itk::SizeValueType k) {
      if (!this->GetAbortGenerateData())
      {
        slices[k] = this->MakeSlice(*input, chosen[k]);
      }
    },
    nullptr);
  if (this->GetAbortGenerateData())
  {
    throw itk::ProcessAborted(__FILE__, __LINE__);
  }
  TContourStack * output = this->GetOutput();
  output->SetFrame(input->GetU(), input->GetV());
  output->SetOpenStart(input->GetOpenStart());
  output->SetOpenEnd(input->GetOpenEnd());
  output->SetSlices(std::move(slices));
  output->Verify();
  this->UpdateProgress(1.0F);
}
} // namespace bone

#endif
