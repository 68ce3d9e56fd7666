/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityCalibrationFilter_hxx
#define boneDensityCalibrationFilter_hxx

#include "boneDensityCalibrationFilter.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
template <typename TImage, typename TMesh>
DensityCalibrationFilter<TImage, TMesh>::DensityCalibrationFilter()
{
  this->SetPrimaryInputName("Mesh");
  this->AddOptionalInputName("Image");
  this->AddOptionalInputName("Labels");
  this->SetNumberOfRequiredInputs(1);
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TImage, typename TMesh>
itk::DataObject::Pointer
DensityCalibrationFilter<TImage, TMesh>::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType)
{
  return TMesh::New().GetPointer();
}

template <typename TImage, typename TMesh>
void
DensityCalibrationFilter<TImage, TMesh>::SetInput(const TMesh * mesh)
{
  this->SetNthInput(0, const_cast<TMesh *>(mesh));
}

template <typename TImage, typename TMesh>
const TMesh *
DensityCalibrationFilter<TImage, TMesh>::GetInput() const
{
  return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryInput());
}

template <typename TImage, typename TMesh>
TMesh *
DensityCalibrationFilter<TImage, TMesh>::GetOutput()
{
  return itkDynamicCastInDebugMode<TMesh *>(this->GetPrimaryOutput());
}

template <typename TImage, typename TMesh>
const TMesh *
DensityCalibrationFilter<TImage, TMesh>::GetOutput() const
{
  return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryOutput());
}

template <typename TImage, typename TMesh>
void
DensityCalibrationFilter<TImage, TMesh>::SetLine(double intercept, double slope, DensityQuantity to)
{
  if (m_Line && m_Line->intercept == intercept && m_Line->slope == slope && m_Line->to == to)
  {
    return;
  }
  DensityLaw line;
  line.name = "line";
  line.to = to;
  line.slope = slope;
  line.intercept = intercept;
  line.high = std::numeric_limits<double>::infinity();
  line.low = -line.high;
  m_Line = line;
  m_References.clear();
  this->Modified();
}

template <typename TImage, typename TMesh>
void
DensityCalibrationFilter<TImage, TMesh>::SetReferences(const std::vector<DensityReference> & references,
                                                       DensityQuantity                       to)
{
  if (!m_Line && m_References == references && m_ReferenceQuantity == to)
  {
    return;
  }
  m_Line.reset();
  m_References = references;
  m_ReferenceQuantity = to;
  this->Modified();
}

template <typename TImage, typename TMesh>
void
DensityCalibrationFilter<TImage, TMesh>::SetLaws(const std::vector<std::string> & names)
{
  if (m_Laws != names)
  {
    m_Laws = names;
    this->Modified();
  }
}

template <typename TImage, typename TMesh>
void
DensityCalibrationFilter<TImage, TMesh>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (!m_Line && m_References.empty() && m_Laws.empty())
  {
    itkExceptionMacro(
      "There is nothing to apply; give a line (SetLine), references (SetReferences) or laws (SetLaws).");
  }
  if (m_Line && !(std::isfinite(m_Line->intercept) && std::isfinite(m_Line->slope) && m_Line->slope > 0))
  {
    itkExceptionMacro("The line is " << m_Line->intercept << " + " << m_Line->slope
                                     << " HU; both must be finite and the slope positive.");
  }
  const DensityQuantity to = m_Line ? m_Line->to : m_ReferenceQuantity;
  if ((m_Line || !m_References.empty()) && (to == DensityQuantity::Unknown || to == DensityQuantity::HounsfieldUnit))
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

template <typename TImage, typename TMesh>
CalibrationReference
DensityCalibrationFilter<TImage, TMesh>::Measure(const DensityReference & reference) const
{
  CalibrationReference measured{ reference.name, 0.0, reference.density };
  if (const auto * value = std::get_if<double>(&reference.measure))
  {
    measured.value = *value;
    return measured;
  }
  const auto *              rod = std::get_if<ReferenceRegion>(&reference.measure);
  const ReferenceStatistics statistics =
    rod ? MeasureReference(*this->GetImage(), *rod)
        : MeasureReference(*this->GetImage(), *this->GetLabels(), std::get<int>(reference.measure));
  if (statistics.voxels == 0)
  {
    itkExceptionMacro("Reference '" << reference.name << "' holds no voxel of the image.");
  }
  measured.value = statistics.mean;
  return measured;
}

template <typename TImage, typename TMesh>
void
DensityCalibrationFilter<TImage, TMesh>::GenerateData()
{
  m_Calibration.reset();
  m_Steps.clear();
  MeshArrays              mesh = this->GetInput()->GetArrays();
  std::vector<DensityLaw> laws;
  try
  {
    if (m_Line)
    {
      laws.push_back(*m_Line);
    }
    else if (!m_References.empty())
    {
      std::vector<CalibrationReference> measured;
      for (const DensityReference & reference : m_References)
      {
        measured.push_back(this->Measure(reference));
      }
      m_Calibration = CalibrateDensity(measured, m_ReferenceQuantity);
      laws.push_back(m_Calibration->law);
    }
    for (const std::string & name : m_Laws)
    {
      laws.push_back(FindDensityLaw(name));
    }
    for (const DensityLaw & law : laws)
    {
      const double outside = ConvertDensity(mesh, law);
      m_Steps.push_back({ law, outside });
    }
  }
  catch (const std::invalid_argument & error)
  {
    itkExceptionMacro(<< error.what());
  }
  this->GetOutput()->SetArrays(std::move(mesh));
}

template <typename TImage, typename TMesh>
void
DensityCalibrationFilter<TImage, TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  if (m_Line)
  {
    os << indent << "Line: " << m_Line->intercept << " + " << m_Line->slope << " HU, "
       << DensityQuantityName(m_Line->to) << std::endl;
  }
  os << indent << "References: " << m_References.size() << ", " << DensityQuantityName(m_ReferenceQuantity)
     << std::endl;
  os << indent << "Laws:";
  for (const std::string & name : m_Laws)
  {
    os << ' ' << name;
  }
  os << std::endl;
}
} // namespace bone

#endif
