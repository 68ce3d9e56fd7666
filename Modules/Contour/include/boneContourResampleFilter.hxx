/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourResampleFilter_hxx
#define boneContourResampleFilter_hxx

#include "boneContourResampleFilter.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
  this->CheckParameter("InnerToleranceFactor", m_InnerToleranceFactor);
  this->CheckParameter("ThinLayerRatio", m_ThinLayerRatio);
  if (!(m_MinimumSpacing <= m_MaximumSpacing))
  {
    itkExceptionMacro("MinimumSpacing (" << m_MinimumSpacing << ") is more than MaximumSpacing (" << m_MaximumSpacing
                                         << ").");
  }
  if (m_TargetNumberOfSamples > 0 && m_TargetNumberOfTetrahedra > 0)
  {
    itkExceptionMacro("Both TargetNumberOfSamples and TargetNumberOfTetrahedra are set; one of them must be 0.");
  }
}

template <typename TContourStack>
void
ContourResampleFilter<TContourStack>::SampleAll()
{
  m_SliceReports.assign(this->GetInput()->GetSlices().size(), SamplingReport{});
  Superclass::GenerateData();
}

// The count goes about with 1 / scale: secant rule on the logarithms, with that slope at first.
template <typename TContourStack>
void
ContourResampleFilter<TContourStack>::SampleForTarget()
{
  constexpr double tolerance = 0.02;
  constexpr int    mostTrials = 8;
  const bool       samples = m_TargetNumberOfSamples > 0;
  const auto       target = static_cast<double>(samples ? m_TargetNumberOfSamples : m_TargetNumberOfTetrahedra);
  double           bestScale = 1.0;
  double           bestError = std::numeric_limits<double>::max();
  double           lastScale = 0.0;
  double           lastError = 0.0;
  double           slope = -1.0;
  for (int trial = 0; trial < mostTrials && bestError > tolerance; ++trial)
  {
    this->SampleAll();
    const double count =
      samples ? static_cast<double>(CountSamples(*this->GetOutput())) : EstimateTetrahedra(*this->GetOutput());
    const double error = std::log(count / target);
    if (std::abs(error) < bestError)
    {
      bestError = std::abs(error);
      bestScale = m_SpacingScale;
    }
    const double scale = std::log(m_SpacingScale);
    if (trial > 0 && std::abs(scale - lastScale) > 1e-6)
    {
      slope = std::clamp((error - lastError) / (scale - lastScale), -2.0, -0.3);
    }
    lastScale = scale;
    lastError = error;
    m_SpacingScale = std::exp(scale - error / slope);
  }
  m_SpacingScale = bestScale;
  if (bestError > tolerance)
  {
    m_Warnings.push_back("The nearest to " + std::to_string(static_cast<std::size_t>(target)) +
                         (samples ? " samples" : " tetrahedra") + " that was found is off by " +
                         std::to_string(static_cast<int>(std::lround(100.0 * std::expm1(bestError)))) + " %.");
    this->SampleAll();
  }
}

template <typename TContourStack>
void
ContourResampleFilter<TContourStack>::GenerateData()
{
  m_Report = {};
  m_Warnings.clear();
  m_SpacingScale = 1.0;
  if (m_TargetNumberOfSamples > 0 || m_TargetNumberOfTetrahedra > 0)
  {
    this->SampleForTarget();
  }
  else
  {
    this->SampleAll();
  }
  for (std::size_t k = 0; k < m_SliceReports.size(); ++k)
  {
    m_Report.samples += m_SliceReports[k].samples;
    m_Report.moved += m_SliceReports[k].moved;
    m_Report.near += m_SliceReports[k].near;
    m_Report.refined += m_SliceReports[k].refined;
    m_Report.unfitted += m_SliceReports[k].unfitted;
    m_Report.largestError = std::max(m_Report.largestError, m_SliceReports[k].largestError);
    if (m_SliceReports[k].unfitted > 0)
    {
      m_Warnings.push_back("Slice " + std::to_string(k) + ": " + std::to_string(m_SliceReports[k].unfitted) +
                           " contours kept as given; a spline would cross another contour.");
    }
    if (m_SliceReports[k].near > 0)
    {
      m_Warnings.push_back("Slice " + std::to_string(k) + ": " + std::to_string(m_SliceReports[k].near) +
                           " inner contours are nearer to the one around them than MinimumLayerDistance.");
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
  parameters.minimumDistance = m_MinimumLayerDistance;
  parameters.spacingScale = m_SpacingScale;
  parameters.innerTolerance = m_InnerToleranceFactor;
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
  os << indent << "InnerToleranceFactor: " << m_InnerToleranceFactor << '\n';
  os << indent << "ThinLayerRatio: " << m_ThinLayerRatio << '\n';
  os << indent << "TargetNumberOfSamples: " << m_TargetNumberOfSamples << '\n';
  os << indent << "TargetNumberOfTetrahedra: " << m_TargetNumberOfTetrahedra << '\n';
  os << indent << "SpacingScale: " << m_SpacingScale << '\n';
}
} // namespace bone

#endif
