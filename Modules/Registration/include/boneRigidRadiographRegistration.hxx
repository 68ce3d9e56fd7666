/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRigidRadiographRegistration_hxx
#define boneRigidRadiographRegistration_hxx

#include "boneMeshRadiograph.h"
#include "boneRigidRadiographRegistration.h"

namespace bone
{
template <typename TMesh, typename TImage>
RigidRadiographRegistration<TMesh, TImage>::RigidRadiographRegistration()
{
  this->AddRequiredInputName("Model");
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TMesh, typename TImage>
void
RigidRadiographRegistration<TMesh, TImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
}

template <typename TMesh, typename TImage>
void
RigidRadiographRegistration<TMesh, TImage>::GenerateData()
{
  const HierarchyType *   model = this->GetModel();
  std::vector<MeshArrays> levels;
  for (std::size_t i = 0; i < model->GetNumberOfLevels(); ++i)
  {
    levels.push_back(model->GetMesh(i)->GetArrays());
    const std::string obstacle =
      FindObstacle(levels.back().points, levels.back(), MeshRadiographParameters{}, HUToAttenuation::None);
    if (!obstacle.empty())
    {
      itkExceptionMacro("Level " << i + 1 << " of the input 'Model': " << obstacle);
    }
  }
  if (levels.empty())
  {
    itkExceptionMacro("The input 'Model' has no level.");
  }
  const std::vector<RadiographView> views = this->CopyViews();
  try
  {
    m_Result = RegisterRigid(levels,
                             views,
                             this->GetInitialPose(),
                             this->GetParameters(),
                             Execution(this),
                             [this](const RigidPose & pose, double cost) {
                               m_CurrentPose = pose;
                               this->TellStep(cost);
                             });
  }
  catch (const std::invalid_argument & error)
  {
    itkExceptionMacro("" << error.what());
  }
  this->GetOutput()->Set(m_Result.pose.ToTransform());
}

template <typename TMesh, typename TImage>
void
RigidRadiographRegistration<TMesh, TImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, this->GetParameters());
  os << indent << "Quality: " << ParameterText(m_Result.quality) << '\n';
  os << indent << "Distinctness: " << m_Result.distinctness << '\n';
  os << indent << "CurrentPose: " << m_CurrentPose.translation.transpose() << '\n';
}
} // namespace bone

#endif
