/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourSliceFilter_hxx
#define boneContourSliceFilter_hxx

#include "boneContourSliceFilter.h"

#include <cmath>
#include <numeric>

namespace bone
{
template <typename TContourStack>
void
ContourSliceFilter<TContourStack>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  this->CheckParameter("MeanSpacing", m_MeanSpacing, true);
  this->CheckParameter("MaximumGap", m_MaximumGap);
  if (m_MaximumGap < 1.0)
  {
    itkExceptionMacro("MaximumGap is " << m_MaximumGap << "; it must be 1 or more.");
  }
}

template <typename TContourStack>
std::vector<std::size_t>
ContourSliceFilter<TContourStack>::ChooseSlices(const TContourStack & input)
{
  m_MisplacedVolume = 0.0;
  if (!(m_MeanSpacing > 0.0))
  {
    return Superclass::ChooseSlices(input);
  }
  const double height = input.GetHeight(input.GetSlices().size() - 1) - input.GetHeight(0);
  const auto   count = static_cast<std::size_t>(std::lround(height / m_MeanSpacing)) + 1;
  auto         selection =
    SelectSlices(input, count, m_MaximumGap * m_MeanSpacing, [this](std::size_t number, const auto & body) {
      this->GetMultiThreader()->ParallelizeArray(
        0, number, [&body](itk::SizeValueType i) { body(i); }, nullptr);
    });
  m_MisplacedVolume = selection.volume;
  return selection.slices;
}

template <typename TContourStack>
ContourSlice
ContourSliceFilter<TContourStack>::MakeSlice(const TContourStack & input, std::size_t k)
{
  return input.GetSlices()[k];
}

template <typename TContourStack>
void
ContourSliceFilter<TContourStack>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "MeanSpacing: " << m_MeanSpacing << '\n'
     << indent << "MaximumGap: " << m_MaximumGap << '\n'
     << indent << "MisplacedVolume: " << m_MisplacedVolume << '\n';
}
} // namespace bone

#endif
