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
  this->SetPrimaryInputName("TrainingSet");
  this->RemoveRequiredInputName("TrainingSet");
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
StatisticalModelEstimator<TMesh>::AddSubject(const std::string & name, const TMesh * mesh)
{
  this->itk::ProcessObject::SetInput(InputName(m_Names.size()), const_cast<TMesh *>(mesh));
  m_Names.push_back(name);
  this->Modified();
}

template <typename TMesh>
void
StatisticalModelEstimator<TMesh>::RemoveSubjects()
{
  for (std::size_t i = 0; i < m_Names.size(); ++i)
  {
    this->RemoveInput(InputName(i));
  }
  m_Names.clear();
  this->Modified();
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
StatisticalModelEstimator<TMesh>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  if (this->GetAlignment() == AlignmentKind::Affine)
  {
    itkExceptionMacro("Alignment must be None, Rigid or Similarity: an affine one would take the shape's modes away.");
  }
  if ((this->GetInput() == nullptr) == m_Names.empty())
  {
    itkExceptionMacro("The inputs must be either subjects (AddSubject) or a 'TrainingSet', and not both.");
  }
}

template <typename TMesh>
void
StatisticalModelEstimator<TMesh>::GenerateData()
{
  const Execution           execution(this);
  TrainingSet::ConstPointer set = this->GetInput();
  if (set.IsNull())
  {
    auto subjects = MeshTrainingSet<TMesh>::New();
    for (std::size_t i = 0; i < m_Names.size(); ++i)
    {
      subjects->AddSubject(m_Names[i], static_cast<const TMesh *>(this->itk::ProcessObject::GetInput(InputName(i))));
    }
    set = subjects.GetPointer();
  }
  const auto *   atlas = this->GetAtlas();
  TrainingResult result =
    TrainModel(*set, this->GetParameters(), execution, atlas != nullptr ? &atlas->GetContent() : nullptr);
  m_Deviations = std::move(result.subjects);
  this->GetOutput()->SetContent(std::move(result.content));
  execution.Report(1.0);
}

template <typename TMesh>
void
StatisticalModelEstimator<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, this->GetParameters());
  os << indent << "Subjects: " << m_Names.size() << '\n';
}
} // namespace bone

#endif
