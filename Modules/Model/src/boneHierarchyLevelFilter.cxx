/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHierarchyLevelFilter.h"

#include "boneExecution.h"

namespace bone
{
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
  Execution(this).Report(1.0);
}

void
HierarchyLevelFilter::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Level: " << m_Level << '\n';
}
} // namespace bone
