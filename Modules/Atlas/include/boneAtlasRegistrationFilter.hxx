/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasRegistrationFilter_hxx
#define boneAtlasRegistrationFilter_hxx

#include "boneAtlasRegistrationFilter.h"

namespace bone
{
template <typename TMesh>
AtlasRegistrationFilter<TMesh>::AtlasRegistrationFilter()
{
  this->AddRequiredInputName("Standard");
  this->AddOptionalInputName("Subject");
  this->AddOptionalInputName("SubjectSurface");
}

template <typename TMesh>
void
AtlasRegistrationFilter<TMesh>::SetSubject(const TMesh * mesh)
{
  this->ProcessObject::RemoveInput("SubjectSurface");
  this->ProcessObject::SetInput("Subject", const_cast<TMesh *>(mesh));
}

template <typename TMesh>
void
AtlasRegistrationFilter<TMesh>::SetSubjectSurface(const TriangleSurface & surface)
{
  this->ProcessObject::RemoveInput("Subject");
  auto * decorator = static_cast<SurfaceType *>(this->ProcessObject::GetInput("SubjectSurface"));
  if (decorator == nullptr)
  {
    auto created = SurfaceType::New();
    created->Set(surface);
    this->ProcessObject::SetInput("SubjectSurface", created);
    return;
  }
  decorator->Set(surface); // newer only where it differs
}

template <typename TMesh>
void
AtlasRegistrationFilter<TMesh>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  if (this->GetSubject() == nullptr && this->ProcessObject::GetInput("SubjectSurface") == nullptr)
  {
    itkExceptionMacro("The input 'Subject' is missing: give the subject as a mesh or as a surface.");
  }
  if (this->GetAlignment() == AlignmentKind::None)
  {
    itkExceptionMacro("Alignment must be Rigid, Similarity or Affine.");
  }
}

template <typename TMesh>
SubjectSurfaces
AtlasRegistrationFilter<TMesh>::TakeSubject() const
{
  if (this->GetSubject() == nullptr)
  {
    return { static_cast<const SurfaceType *>(this->ProcessObject::GetInput("SubjectSurface"))->Get(), {} };
  }
  SubjectSurfaces surfaces = SurfacesOf(this->GetSubject()->GetArrays());
  if (!this->GetFitLayers())
  {
    surfaces.inner.clear();
  }
  return surfaces;
}

template <typename TMesh>
void
AtlasRegistrationFilter<TMesh>::GenerateData()
{
  const Execution execution(this);
  const TMesh *   standard = this->GetStandard();
  MeshArrays      arrays = standard->GetArrays();
  try
  {
    if (m_Standard == nullptr || m_StandardTime != standard->GetMTime())
    {
      m_Standard = std::make_unique<StandardModel>(arrays);
      m_StandardTime = standard->GetMTime();
    }
    arrays.points = m_Standard->Register(this->TakeSubject(), this->GetParameters(), m_Report, execution);
  }
  catch (const std::logic_error & error)
  {
    itkExceptionMacro("" << error.what());
  }
  catch (const std::runtime_error & error)
  {
    itkExceptionMacro("" << error.what());
  }
  arrays.degree.clear();
  arrays.coefficients.clear();
  arrays.maximumDegree = -1;
  arrays.quantity = DensityQuantity::Unknown;
  this->GetOutput()->SetArrays(std::move(arrays));
  execution.Report(1.0);
}

template <typename TMesh>
void
AtlasRegistrationFilter<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, this->GetParameters());
}
} // namespace bone

#endif
