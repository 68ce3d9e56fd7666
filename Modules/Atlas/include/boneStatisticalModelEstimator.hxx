/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStatisticalModelEstimator_hxx
#define boneStatisticalModelEstimator_hxx

#include "boneStatisticalModelEstimator.h"

namespace bone
{
template <typename TMesh>
StatisticalModelEstimator<TMesh>::StatisticalModelEstimator()
{
  this->SetNumberOfRequiredInputs(1);
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TMesh>
itk::DataObject::Pointer
StatisticalModelEstimator<TMesh>::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType)
{
  return StatisticalModel::New().GetPointer();
}

template <typename TMesh>
void
StatisticalModelEstimator<TMesh>::SetInput(const TrainingSet * set)
{
  this->SetNthInput(0, const_cast<TrainingSet *>(set));
}

template <typename TMesh>
const TrainingSet *
StatisticalModelEstimator<TMesh>::GetInput() const
{
  return itkDynamicCastInDebugMode<const TrainingSet *>(this->GetPrimaryInput());
}

template <typename TMesh>
StatisticalModel *
StatisticalModelEstimator<TMesh>::GetOutput()
{
  return itkDynamicCastInDebugMode<StatisticalModel *>(this->GetPrimaryOutput());
}

template <typename TMesh>
const StatisticalModel *
StatisticalModelEstimator<TMesh>::GetOutput() const
{
  return itkDynamicCastInDebugMode<const StatisticalModel *>(this->GetPrimaryOutput());
}

template <typename TMesh>
void
StatisticalModelEstimator<TMesh>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (m_Alignment == AlignmentKind::Affine)
  {
    itkExceptionMacro("Alignment must be None, Rigid or Similarity: an affine one would take the shape's modes away.");
  }
  if (!(m_VarianceProportion > 0 && m_VarianceProportion <= 1))
  {
    itkExceptionMacro("VarianceProportion is " << m_VarianceProportion << "; it must be above 0 and at most 1.");
  }
  if (!(m_WithinCellWeight > 0 && m_WithinCellWeight <= 1))
  {
    itkExceptionMacro("WithinCellWeight is " << m_WithinCellWeight << "; it must be above 0 and at most 1.");
  }
  if (m_MaximumModes < 0)
  {
    itkExceptionMacro("MaximumModes is " << m_MaximumModes << "; it must not be negative.");
  }
  if (!(m_OutlierThreshold >= 0))
  {
    itkExceptionMacro("OutlierThreshold is " << m_OutlierThreshold << "; it must not be negative.");
  }
}

template <typename TMesh>
void
StatisticalModelEstimator<TMesh>::GenerateData()
{
  TrainingParameters parameters;
  parameters.alignment = m_Alignment;
  parameters.proportion = m_VarianceProportion;
  parameters.maximumModes = m_MaximumModes;
  parameters.combined = m_Combined;
  parameters.volumeWeighted = m_VolumeWeighted;
  parameters.withinCellWeight = m_WithinCellWeight;
  parameters.outlierThreshold = m_OutlierThreshold;
  parameters.rejectOutliers = m_RejectOutliers;
  parameters.blockBytes = m_BlockBytes;
  TrainingResult result = TrainModel(*this->GetInput(), parameters, [this](double done) {
    this->UpdateProgress(static_cast<float>(done));
    if (this->GetAbortGenerateData())
    {
      throw itk::ProcessAborted(__FILE__, __LINE__);
    }
  });
  m_Deviations = std::move(result.subjects);
  this->GetOutput()->SetContent(std::move(result.content));
}

template <typename TMesh>
void
StatisticalModelEstimator<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Alignment: " << static_cast<int>(m_Alignment) << std::endl;
  os << indent << "VarianceProportion: " << m_VarianceProportion << std::endl;
  os << indent << "MaximumModes: " << m_MaximumModes << std::endl;
  os << indent << "Combined: " << m_Combined << std::endl;
  os << indent << "VolumeWeighted: " << m_VolumeWeighted << std::endl;
  os << indent << "WithinCellWeight: " << m_WithinCellWeight << std::endl;
  os << indent << "OutlierThreshold: " << m_OutlierThreshold << std::endl;
  os << indent << "RejectOutliers: " << m_RejectOutliers << std::endl;
  os << indent << "BlockBytes: " << m_BlockBytes << std::endl;
}
} // namespace bone

#endif
