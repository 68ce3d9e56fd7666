/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourStackFilter.h"

#include <numeric>

namespace bone
{
std::vector<std::size_t>
ContourStackFilter::ChooseSlices(const ContourStack & input, const Execution &)
{
  std::vector<std::size_t> all(input.GetSlices().size());
  std::iota(all.begin(), all.end(), std::size_t{ 0 });
  return all;
}

void
ContourStackFilter::MakeSlices(const Execution & execution)
{
  const ContourStack * input = this->GetInput();
  if (input->GetNumberOfContours() == 0)
  {
    itkExceptionMacro("The input 'Contours' holds no contour.");
  }
  input->Verify();
  const std::vector<std::size_t> chosen = this->ChooseSlices(*input, execution.Part(0.0, 0.9));
  ContourStack::SliceContainer   slices(chosen.size());
  execution.For(slices.size(), [&](std::size_t k) { slices[k] = this->MakeSlice(*input, chosen[k]); });
  ContourStack * output = this->GetOutput();
  output->SetFrame(input->GetU(), input->GetV());
  output->SetOpenStart(input->GetOpenStart());
  output->SetOpenEnd(input->GetOpenEnd());
  output->SetSlices(std::move(slices));
  output->Verify();
}
} // namespace bone
