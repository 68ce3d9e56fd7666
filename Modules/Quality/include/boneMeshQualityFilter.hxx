/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshQualityFilter_hxx
#define boneMeshQualityFilter_hxx

#include "boneMeshQualityFilter.h"

#include <optional>
#include <string>

namespace bone
{
template <typename TMesh>
void
MeshQualityFilter<TMesh>::SetContours(const ContourStack * contours)
{
  this->ProcessObject::SetInput("Contours", const_cast<ContourStack *>(contours));
}

template <typename TMesh>
const ContourStack *
MeshQualityFilter<TMesh>::GetContours() const
{
  return dynamic_cast<const ContourStack *>(this->ProcessObject::GetInput("Contours"));
}

template <typename TMesh>
void
MeshQualityFilter<TMesh>::SetLabelImage(const LabelImageType * labels)
{
  this->ProcessObject::SetInput("LabelImage", const_cast<LabelImageType *>(labels));
}

template <typename TMesh>
auto
MeshQualityFilter<TMesh>::GetLabelImage() const -> const LabelImageType *
{
  return dynamic_cast<const LabelImageType *>(this->ProcessObject::GetInput("LabelImage"));
}

template <typename TMesh>
void
MeshQualityFilter<TMesh>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (m_Iterations < 0 || m_FairingIterations < 0 || m_Rounds < 0 || m_OptimizationPasses < 0)
  {
    itkExceptionMacro("Iterations (" << m_Iterations << "), FairingIterations (" << m_FairingIterations << "), Rounds ("
                                     << m_Rounds << ") and OptimizationPasses (" << m_OptimizationPasses
                                     << ") must not be negative.");
  }
  if (!(m_DistanceBound >= 0 && std::isfinite(m_DistanceBound)))
  {
    itkExceptionMacro("DistanceBound is " << m_DistanceBound << " mm; it must be finite and not negative.");
  }
  if (!(m_Gradation >= 0 && std::isfinite(m_Gradation)))
  {
    itkExceptionMacro("Gradation is " << m_Gradation << "; it must be finite and not negative.");
  }
  if (!(m_SliverFactor >= 1 && std::isfinite(m_SliverFactor)))
  {
    itkExceptionMacro("SliverFactor is " << m_SliverFactor << "; it must be finite and at least 1.");
  }
  if (!(m_Stiffness >= 0 && std::isfinite(m_Stiffness)))
  {
    itkExceptionMacro("Stiffness is " << m_Stiffness << "; it must be finite and not negative.");
  }
  if (!(m_TargetAngle > 0 && m_TargetAngle < 1.23))
  {
    itkExceptionMacro("TargetAngle is " << m_TargetAngle
                                        << " rad; it must lie between 0 and 1.23, the angle of a regular tetrahedron.");
  }
}

template <typename TMesh>
void
MeshQualityFilter<TMesh>::Improve(TetraComplex & complex, const ProgressFunction & progress)
{
  ImprovementParameters parameters;
  parameters.iterations = m_Iterations;
  parameters.distanceBound = m_DistanceBound;
  parameters.fairingIterations = m_FairingIterations;
  parameters.rounds = m_Rounds;
  parameters.targetAngle = m_TargetAngle;
  parameters.gradation = m_Gradation;
  parameters.optimizationPasses = m_OptimizationPasses;
  parameters.sliverFactor = m_SliverFactor;
  parameters.stiffness = m_Stiffness;
  std::optional<ContourShape> shape;
  if (this->GetContours())
  {
    shape.emplace(*this->GetContours());
    parameters.shape = &*shape;
  }
  LabelOutline outline;
  if (this->GetLabelImage())
  {
    outline = FindOutline(*this->GetLabelImage(), m_Label);
    if (outline.voxels.empty())
    {
      itkExceptionMacro("The input LabelImage has no outline of "
                        << (m_Label == 0 ? "any label" : "label " + std::to_string(m_Label))
                        << "; set Label to one that it has.");
    }
    parameters.outline = &outline;
  }
  parameters.slices = this->GetInput()->GetArrays().slice;
  m_Report = ImproveMesh(complex, parameters, progress);
}

template <typename TMesh>
void
MeshQualityFilter<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Label: " << m_Label << std::endl;
  os << indent << "Iterations: " << m_Iterations << std::endl;
  os << indent << "DistanceBound: " << m_DistanceBound << std::endl;
  os << indent << "FairingIterations: " << m_FairingIterations << std::endl;
  os << indent << "Rounds: " << m_Rounds << std::endl;
  os << indent << "TargetAngle: " << m_TargetAngle << std::endl;
  os << indent << "Gradation: " << m_Gradation << std::endl;
  os << indent << "OptimizationPasses: " << m_OptimizationPasses << std::endl;
  os << indent << "SliverFactor: " << m_SliverFactor << std::endl;
  os << indent << "Stiffness: " << m_Stiffness << std::endl;
}
} // namespace bone

#endif
