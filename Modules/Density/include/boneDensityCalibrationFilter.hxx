/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityCalibrationFilter_hxx
#define boneDensityCalibrationFilter_hxx

#include "boneDensityCalibrationFilter.h"

#include <limits>
#include <stdexcept>

namespace bone
{
template <typename TImage, typename TMesh, typename TLabelImage>
DensityCalibrationFilter<TImage, TMesh, TLabelImage>::DensityCalibrationFilter()
{
  this->AddOptionalInputName("Image");
  this->AddOptionalInputName("Labels");
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
DensityCalibrationFilter<TImage, TMesh, TLabelImage>::SetLine(double intercept, double slope, DensityQuantity to)
{
  if (!m_References.empty())
  {
    m_References.clear();
    this->Modified();
  }
  this->SetLine(std::vector<double>{ intercept, slope });
  this->SetQuantity(to);
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
DensityCalibrationFilter<TImage, TMesh, TLabelImage>::SetReferences(const std::vector<DensityReference> & references,
                                                                    DensityQuantity                       to)
{
  if (m_References != references)
  {
    m_References = references;
    this->Modified();
  }
  this->SetLine(std::vector<double>());
  this->SetQuantity(to);
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
DensityCalibrationFilter<TImage, TMesh, TLabelImage>::SetLaws(const std::vector<std::string> & names)
{
  if (m_Laws != names)
  {
    m_Laws = names;
    this->Modified();
  }
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
DensityCalibrationFilter<TImage, TMesh, TLabelImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  const std::vector<double> & line = m_Parameters.line;
  if (line.empty() && m_References.empty() && m_Laws.empty())
  {
    itkExceptionMacro(
      "There is nothing to apply; a line, references or laws are needed.");
  }
  if (!line.empty() && !m_References.empty())
  {
    itkExceptionMacro("Both a line and references are given: set Line to an empty one, or take the references out.");
  }
  if (!line.empty() && !(line.size() == 2 && line[1] > 0))
  {
    itkExceptionMacro("Line is " << ParameterText(line) << ", but must be an intercept and a slope above 0.");
  }
  const DensityQuantity to = m_Parameters.quantity;
  if (!(line.empty() && m_References.empty()) &&
      (to == DensityQuantity::Unknown || to == DensityQuantity::HounsfieldUnit))
  {
    itkExceptionMacro("The line leads to " << DensityQuantityName(to)
                                           << "; it must lead to a mineral, ash or apparent density.");
  }
  for (const DensityReference & reference : m_References)
  {
    const bool isLabel = std::holds_alternative<int>(reference.measure);
    if (!std::holds_alternative<double>(reference.measure) && !this->GetImage())
    {
      itkExceptionMacro("Reference '" << reference.name << "' is to be measured, but the input 'Image' is missing.");
    }
    if (isLabel && !this->GetLabels())
    {
      itkExceptionMacro("Reference '" << reference.name
                                      << "' is named by its label, but the input 'Labels' is missing.");
    }
    if (isLabel && this->GetLabels()->GetBufferedRegion() != this->GetImage()->GetBufferedRegion())
    {
      itkExceptionMacro("The grid of the input 'Labels' is not that of 'Image'.");
    }
  }
}

template <typename TImage, typename TMesh, typename TLabelImage>
CalibrationReference
DensityCalibrationFilter<TImage, TMesh, TLabelImage>::Measure(const DensityReference & reference,
                                                              const Execution &        execution) const
{
  CalibrationReference measured{ reference.name, 0.0, reference.density };
  if (const auto * value = std::get_if<double>(&reference.measure))
  {
    measured.value = *value;
    return measured;
  }
  const auto *              rod = std::get_if<ReferenceRegion>(&reference.measure);
  const ReferenceStatistics statistics =
    rod ? MeasureReference(*this->GetImage(), *rod, execution)
        : MeasureReference(*this->GetImage(), *this->GetLabels(), std::get<int>(reference.measure), execution);
  if (statistics.voxels == 0)
  {
    itkExceptionMacro("Reference '" << reference.name << "' holds no voxel of the input 'Image'.");
  }
  measured.value = statistics.mean;
  return measured;
}

template <typename TImage, typename TMesh, typename TLabelImage>
std::vector<DensityLaw>
DensityCalibrationFilter<TImage, TMesh, TLabelImage>::CollectLaws(const Execution & execution)
{
  std::vector<DensityLaw> laws;
  if (!m_Parameters.line.empty())
  {
    DensityLaw line;
    line.name = "line";
    line.to = m_Parameters.quantity;
    line.intercept = m_Parameters.line[0];
    line.slope = m_Parameters.line[1];
    line.high = std::numeric_limits<double>::infinity();
    line.low = -line.high;
    laws.push_back(line);
  }
  else if (!m_References.empty())
  {
    std::vector<CalibrationReference> measured;
    const auto                        count = static_cast<double>(m_References.size());
    for (const DensityReference & reference : m_References)
    {
      const auto      done = static_cast<double>(measured.size());
      const Execution part = execution.Part(done / count, (done + 1.0) / count);
      measured.push_back(this->Measure(reference, part));
      part.Report(1.0);
    }
    m_Calibration = CalibrateDensity(measured, m_Parameters.quantity);
    laws.push_back(m_Calibration->law);
  }
  for (const std::string & name : m_Laws)
  {
    laws.push_back(FindDensityLaw(name));
  }
  return laws;
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
DensityCalibrationFilter<TImage, TMesh, TLabelImage>::GenerateData()
{
  const Execution execution(this);
  m_Calibration.reset();
  m_Steps.clear();
  MeshArrays mesh = this->CopyInput();
  try
  {
    for (const DensityLaw & law : this->CollectLaws(execution.Part(0.0, 0.9)))
    {
      const double outside = ConvertDensity(mesh, law);
      m_Steps.push_back({ law, outside });
      execution.ThrowIfAborted();
    }
  }
  catch (const std::invalid_argument & error)
  {
    itkExceptionMacro("" << error.what());
  }
  this->SetResult(std::move(mesh));
  execution.Report(1.0);
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
DensityCalibrationFilter<TImage, TMesh, TLabelImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "References: " << m_References.size() << '\n';
  os << indent << "Laws:";
  for (const std::string & name : m_Laws)
  {
    os << ' ' << name;
  }
  os << '\n';
}
} // namespace bone

#endif
