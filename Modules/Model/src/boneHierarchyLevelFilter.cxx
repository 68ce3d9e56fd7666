/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHierarchyLevelFilter.h"

namespace bone
{
HierarchyLevelFilter::HierarchyLevelFilter()
{
  this->SetNumberOfRequiredInputs(1);
  this->SetNthOutput(0, MeshType::New());
}

void
HierarchyLevelFilter::SetInput(const HierarchyType * hierarchy)
{
  this->SetNthInput(0, const_cast<HierarchyType *>(hierarchy));
}

HierarchyLevelFilter::MeshType *
HierarchyLevelFilter::GetOutput()
{
  return static_cast<MeshType *>(this->GetPrimaryOutput());
}

itk::DataObject::Pointer
HierarchyLevelFilter::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType)
{
  return MeshType::New().GetPointer();
}

void
HierarchyLevelFilter::GenerateData()
{
  const auto * hierarchy = static_cast<const HierarchyType *>(this->GetPrimaryInput());
  if (m_Level >= hierarchy->GetNumberOfLevels())
  {
    itkExceptionMacro("Level " << m_Level + 1 << " was asked for; the hierarchy has " << hierarchy->GetNumberOfLevels()
                               << '.');
  }
  this->GetOutput()->SetArrays(hierarchy->GetMesh(m_Level)->GetArrays());
}

void
HierarchyLevelFilter::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Level: " << m_Level << '\n';
}
} // namespace bone
