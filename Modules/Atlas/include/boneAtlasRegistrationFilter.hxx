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
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TMesh>
itk::DataObject::Pointer
AtlasRegistrationFilter<TMesh>::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType)
{
  return TMesh::New().GetPointer();
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
TMesh *
AtlasRegistrationFilter<TMesh>::GetOutput()
{
  return itkDynamicCastInDebugMode<TMesh *>(this->GetPrimaryOutput());
}

template <typename TMesh>
const TMesh *
AtlasRegistrationFilter<TMesh>::GetOutput() const
{
  return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryOutput());
}

template <typename TMesh>
void
AtlasRegistrationFilter<TMesh>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (this->GetSubject() == nullptr && this->ProcessObject::GetInput("SubjectSurface") == nullptr)
  {
    itkExceptionMacro("Give the subject as a mesh or as a surface.");
  }
  if (m_Alignment == AlignmentKind::None)
  {
    itkExceptionMacro("Alignment must be Rigid, Similarity or Affine.");
  }
  if (!(m_ExteriorBound >= 0))
  {
    itkExceptionMacro("ExteriorBound is " << m_ExteriorBound << " mm; it must not be negative.");
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
  if (!m_FitLayers)
  {
    surfaces.inner.clear();
  }
  return surfaces;
}

template <typename TMesh>
void
AtlasRegistrationFilter<TMesh>::GenerateData()
{
  const TMesh *          standard = this->GetStandard();
  RegistrationParameters parameters;
  parameters.alignment.kind = m_Alignment;
  parameters.mirror = m_Mirror;
  parameters.method = m_Method;
  parameters.interior = m_Interior;
  parameters.untangling.exteriorBound = m_ExteriorBound;
  MeshArrays arrays = standard->GetArrays();
  try
  {
    if (m_Standard == nullptr || m_StandardTime != standard->GetMTime())
    {
      m_Standard = std::make_unique<StandardModel>(arrays);
      m_StandardTime = standard->GetMTime();
    }
    arrays.points = m_Standard->Register(this->TakeSubject(), parameters, m_Report, [this](double done) {
      this->UpdateProgress(static_cast<float>(done));
      if (this->GetAbortGenerateData())
      {
        throw itk::ProcessAborted(__FILE__, __LINE__);
      }
    });
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
}

template <typename TMesh>
void
AtlasRegistrationFilter<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Alignment: " << static_cast<int>(m_Alignment) << std::endl;
  os << indent << "Mirror: " << static_cast<int>(m_Mirror) << std::endl;
  os << indent << "Method: " << static_cast<int>(m_Method) << std::endl;
  os << indent << "Interior: " << static_cast<int>(m_Interior) << std::endl;
  os << indent << "FitLayers: " << (m_FitLayers ? "On" : "Off") << std::endl;
  os << indent << "ExteriorBound: " << m_ExteriorBound << std::endl;
}
} // namespace bone

#endif
