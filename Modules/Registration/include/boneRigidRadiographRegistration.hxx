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
  m_Result.bodies.resize(1);
}

template <typename TMesh, typename TImage>
void
RigidRadiographRegistration<TMesh, TImage>::SetModel(unsigned int body, const HierarchyType * model)
{
  this->itk::ProcessObject::SetInput(NameOfModel(body), const_cast<HierarchyType *>(model));
  const auto bodies = this->GetNumberOfBodies();
  for (auto output = static_cast<unsigned int>(this->GetNumberOfIndexedOutputs()); output < bodies; ++output)
  {
    this->SetNthOutput(output, this->MakeOutput(output));
  }
}

template <typename TMesh, typename TImage>
unsigned int
RigidRadiographRegistration<TMesh, TImage>::GetNumberOfBodies() const
{
  unsigned int bodies = 0;
  while (this->GetModelOf(bodies) != nullptr)
  {
    ++bodies;
  }
  return bodies;
}

template <typename TMesh, typename TImage>
std::vector<MeshArrays>
RigidRadiographRegistration<TMesh, TImage>::CopyLevels(unsigned int body) const
{
  const HierarchyType *   model = this->GetModelOf(body);
  std::vector<MeshArrays> levels;
  for (std::size_t i = 0; i < model->GetNumberOfLevels(); ++i)
  {
    levels.push_back(model->GetMesh(i)->GetArrays());
    const std::string obstacle =
      FindObstacle(levels.back().points, levels.back(), MeshRadiographParameters{}, HUToAttenuation::None);
    if (!obstacle.empty())
    {
      itkExceptionMacro("Level " << i + 1 << " of the input '" << NameOfModel(body) << "': " << obstacle);
    }
  }
  if (levels.empty())
  {
    itkExceptionMacro("The input '" << NameOfModel(body) << "' has no level.");
  }
  return levels;
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
  std::vector<std::vector<MeshArrays>> bodies;
  for (unsigned int body = 0; body < this->GetNumberOfBodies(); ++body)
  {
    bodies.push_back(this->CopyLevels(body));
  }
  const std::vector<RadiographView> views = this->CopyViews();
  try
  {
    m_Result = RegisterRigidBodies(bodies,
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
  for (unsigned int body = 0; body < m_Result.bodies.size(); ++body)
  {
    this->GetOutput(body)->Set(m_Result.bodies[body].pose.ToTransform());
  }
}

template <typename TMesh, typename TImage>
void
RigidRadiographRegistration<TMesh, TImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, this->GetParameters());
  for (const RigidRegistrationResult & result : m_Result.bodies)
  {
    os << indent << "Quality: " << ParameterText(result.quality) << '\n';
    os << indent << "Distinctness: " << result.distinctness << '\n';
  }
  os << indent << "CurrentPose: " << m_CurrentPose.translation.transpose() << '\n';
}
} // namespace bone

#endif
