/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourResampleFilter_hxx
#define boneContourResampleFilter_hxx

#include "boneContourResampleFilter.h"

#include <algorithm>

namespace bone
{
template <typename TContourStack>
void
ContourResampleFilter<TContourStack>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  this->CheckParameter("Tolerance", m_Tolerance);
  this->CheckParameter("MinimumSpacing", m_MinimumSpacing);
  this->CheckParameter("MaximumSpacing", m_MaximumSpacing);
  this->CheckParameter("MinimumLayerDistance", m_MinimumLayerDistance, true);
  this->CheckParameter("ThinLayerRatio", m_ThinLayerRatio);
  if (!(m_MinimumSpacing <= m_MaximumSpacing))
  {
    itkExceptionMacro("MinimumSpacing (" << m_MinimumSpacing << ") is more than MaximumSpacing (" << m_MaximumSpacing
                                         << ").");
  }
}

template <typename TContourStack>
void
ContourResampleFilter<TContourStack>::GenerateData()
{
  m_SliceReports.assign(this->GetInput()->GetSlices().size(), SamplingReport{});
  m_Report = {};
  m_Warnings.clear();
  Superclass::GenerateData();
  for (std::size_t k = 0; k < m_SliceReports.size(); ++k)
  {
    m_Report.refined += m_SliceReports[k].refined;
    m_Report.unfitted += m_SliceReports[k].unfitted;
    m_Report.largestError = std::max(m_Report.largestError, m_SliceReports[k].largestError);
    if (m_SliceReports[k].unfitted > 0)
    {
      m_Warnings.push_back("Slice " + std::to_string(k) + ": " + std::to_string(m_SliceReports[k].unfitted) +
                           " contours kept as given; a spline would cross another contour.");
    }
  }
}

template <typename TContourStack>
ContourSlice
ContourResampleFilter<TContourStack>::MakeSlice(const TContourStack & input, std::size_t k)
{
  SamplingParameters parameters;
  parameters.tolerance = m_Tolerance;
  parameters.minimumSpacing = m_MinimumSpacing;
  parameters.maximumSpacing = m_MaximumSpacing;
  parameters.minimumDistance = 0.5 * m_MinimumLayerDistance;
  parameters.thinLayerRatio = m_ThinLayerRatio;
  return SampleSlice(input.GetSlices()[k], input, parameters, m_SliceReports[k]);
}

template <typename TContourStack>
void
ContourResampleFilter<TContourStack>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Tolerance: " << m_Tolerance << '\n';
  os << indent << "MinimumSpacing: " << m_MinimumSpacing << '\n';
  os << indent << "MaximumSpacing: " << m_MaximumSpacing << '\n';
  os << indent << "MinimumLayerDistance: " << m_MinimumLayerDistance << '\n';
  os << indent << "ThinLayerRatio: " << m_ThinLayerRatio << '\n';
}
} // namespace bone

#endif
