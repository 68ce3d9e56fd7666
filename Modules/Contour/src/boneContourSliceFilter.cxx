/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourSliceFilter.h"

#include "boneSliceSelection.h"

#include <cmath>

namespace bone
{
void
ContourSliceFilter::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
}

std::vector<std::size_t>
ContourSliceFilter::ChooseSlices(const ContourStack & input, const Execution & execution)
{
  const double spacing = m_Parameters.meanSpacing;
  m_MisplacedVolume = 0.0;
  if (!(spacing > 0.0))
  {
    return Superclass::ChooseSlices(input, execution);
  }
  const double height = input.GetHeight(input.GetSlices().size() - 1) - input.GetHeight(0);
  const auto   count = static_cast<std::size_t>(std::lround(height / spacing)) + 1;
  auto         selection = SelectSlices(input, count, m_Parameters.maximumGap * spacing, execution);
  m_MisplacedVolume = selection.volume;
  return selection.slices;
}

ContourSlice
ContourSliceFilter::MakeSlice(const ContourStack & input, std::size_t k)
{
  return input.GetSlices()[k];
}

void
ContourSliceFilter::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "MisplacedVolume: " << m_MisplacedVolume << '\n';
}
} // namespace bone
