/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourResampleFilter.h"

#include "boneContourSampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
void
ContourResampleFilter::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  if (!(m_Parameters.minimumSpacing <= m_Parameters.maximumSpacing))
  {
    itkExceptionMacro("MinimumSpacing (" << m_Parameters.minimumSpacing << ") is more than MaximumSpacing ("
                                         << m_Parameters.maximumSpacing << ").");
  }
  if (m_Parameters.targetNumberOfSamples > 0 && m_Parameters.targetNumberOfTetrahedra > 0)
  {
    itkExceptionMacro("Both TargetNumberOfSamples and TargetNumberOfTetrahedra are set; one of them must be 0.");
  }
}

void
ContourResampleFilter::SampleAll(const Execution & execution)
{
  m_SliceReports.assign(this->GetInput()->GetSlices().size(), SamplingReport{});
  this->MakeSlices(execution);
}

// The count goes about with 1 / scale: secant rule on the logarithms, with that slope at first.
void
ContourResampleFilter::SampleForTarget(const Execution & execution)
{
  constexpr double tolerance = 0.02;
  constexpr int    mostTrials = 8;
  const bool       samples = m_Parameters.targetNumberOfSamples > 0;
  const auto       target =
    static_cast<double>(samples ? m_Parameters.targetNumberOfSamples : m_Parameters.targetNumberOfTetrahedra);
  double bestScale = 1.0;
  double bestError = std::numeric_limits<double>::max();
  double lastScale = 0.0;
  double lastError = 0.0;
  double slope = -1.0;
  for (int trial = 0; trial < mostTrials && bestError > tolerance; ++trial)
  {
    // A few trials do for most: the first ones take the larger shares.
    this->SampleAll(execution.Part(1.0 - std::pow(0.6, trial), 1.0 - std::pow(0.6, trial + 1)));
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
    this->SampleAll(execution);
  }
}

void
ContourResampleFilter::GenerateData()
{
  m_Report = {};
  m_Warnings.clear();
  m_SpacingScale = 1.0;
  if (m_Parameters.targetNumberOfSamples > 0 || m_Parameters.targetNumberOfTetrahedra > 0)
  {
    this->SampleForTarget(Execution(this));
  }
  else
  {
    this->SampleAll(Execution(this));
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

ContourSlice
ContourResampleFilter::MakeSlice(const ContourStack & input, std::size_t k)
{
  return SampleSlice(input.GetSlices()[k], input, m_Parameters, m_SpacingScale, m_SliceReports[k]);
}

void
ContourResampleFilter::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "SpacingScale: " << m_SpacingScale << '\n';
}
} // namespace bone
