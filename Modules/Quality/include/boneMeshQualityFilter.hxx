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
template <typename TMesh, typename TLabelImage>
void
MeshQualityFilter<TMesh, TLabelImage>::Improve(TetraComplex & complex, const Execution & execution)
{
  ImprovementParameters parameters;
  static_cast<MeshQualityParameters &>(parameters) = this->GetParameters();
  std::optional<ContourShape> shape;
  if (this->GetContours())
  {
    shape.emplace(*this->GetContours());
    parameters.shape = &*shape;
  }
  LabelOutline outline;
  if (this->GetLabelImage())
  {
    outline = FindOutline(*this->GetLabelImage(), parameters.label);
    if (outline.voxels.empty())
    {
      itkExceptionMacro("The input 'LabelImage' has no outline of "
                        << (parameters.label == 0 ? "any label" : "label " + std::to_string(parameters.label))
                        << ": choose one that it has.");
    }
    parameters.outline = &outline;
  }
  parameters.slices = this->GetInput()->GetCells().slice;
  m_Report = ImproveMesh(complex, parameters, execution);
}
} // namespace bone

#endif
