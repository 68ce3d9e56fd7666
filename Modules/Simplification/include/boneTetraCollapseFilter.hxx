/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraCollapseFilter_hxx
#define boneTetraCollapseFilter_hxx

#include "boneBuildLevels.h"
#include "boneMeshValidator.h"
#include "boneQualityMeasures.h"
#include "boneTetraCollapseFilter.h"

#include <algorithm>

namespace bone
{
template <typename TMesh>
TetraCollapseFilter<TMesh>::TetraCollapseFilter()
{
  this->SetPrimaryInputName("Mesh");
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, HierarchyType::New());
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  const auto & levels = m_Parameters.levels;
  const auto & errors = m_Parameters.maximumDensityErrors;
  const auto & distances = m_Parameters.maximumSurfaceDistances;
  const auto & cellErrors = m_Parameters.maximumCellErrors;
  if (levels.empty() && errors.empty() && cellErrors.empty() && distances.empty())
  {
    itkExceptionMacro("No levels are asked for; give numbers of tetrahedra (SetLevels), bounds on the density error "
                      "(SetMaximumDensityErrors, SetMaximumCellErrors) or on the distance of surfaces "
                      "(SetMaximumSurfaceDistances).");
  }
  if (!std::is_sorted(levels.rbegin(), levels.rend()))
  {
    itkExceptionMacro("Levels are " << ParameterText(levels)
                                    << " tetrahedra, but must not ascend: each level is coarser than the one before.");
  }
  const auto checkBounds = [this](const std::vector<double> & bounds, const char * name) {
    if (!std::is_sorted(bounds.begin(), bounds.end()))
    {
      itkExceptionMacro("" << name << " are " << ParameterText(bounds)
                           << ", but must not descend: each level is coarser than the one before.");
    }
  };
  if (m_Parameters.improveAngles && !distances.empty())
  {
    itkExceptionMacro("ImproveAngles moves surfaces, which MaximumSurfaceDistances bounds: turn it off, or leave these "
                      "bounds out.");
  }
  if (m_Parameters.improveAngles && !cellErrors.empty())
  {
    itkExceptionMacro(
      "ImproveAngles changes tetrahedra whatever their density error is, which MaximumCellErrors bounds: "
      "turn it off, or leave these bounds out.");
  }
  checkBounds(errors, "MaximumDensityErrors");
  checkBounds(cellErrors, "MaximumCellErrors");
  checkBounds(distances, "MaximumSurfaceDistances");
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::GenerateData()
{
  MeshArrays input = this->GetInput()->GetArrays();
  if (input.tetrahedra.empty())
  {
    itkExceptionMacro("The input 'Mesh' has no tetrahedra.");
  }
  const auto validation = ValidateMesh(input);
  if (!validation.IsValid())
  {
    itkExceptionMacro("The input 'Mesh' cannot be simplified: " << validation.Summary());
  }
  if (!input.HasDensity() && !(m_Parameters.maximumDensityErrors.empty() && m_Parameters.maximumCellErrors.empty()))
  {
    itkExceptionMacro("MaximumDensityErrors or MaximumCellErrors are set, but the input 'Mesh' has no density; fit one "
                      "first.");
  }
  std::vector<typename HierarchyType::Level> levels(1);
  levels[0].mesh = TMesh::New();
  levels[0].mesh->SetArrays(input);
  levels[0].stopReason = "input";
  std::vector<LevelReport> report;
  for (BuiltLevel & built : BuildLevels(std::move(input), m_Parameters, Execution(this)))
  {
    typename HierarchyType::Level level;
    level.mesh = TMesh::New();
    level.mesh->SetArrays(std::move(built.mesh));
    if (m_Parameters.improveAngles && CountInverted(level.mesh->GetArrays()) > 0)
    {
      itkExceptionMacro("Rounding moved points to single precision inverts tetrahedra; use a mesh with double "
                        "coordinates, or turn ImproveAngles off.");
    }
    level.parentPoint = std::move(built.parentPoint);
    level.densityErrorBound = built.densityErrorBound;
    level.densityError = built.densityError;
    level.surfaceError = built.surfaceError;
    level.stopReason = std::move(built.stopReason);
    levels.push_back(std::move(level));
    report.push_back({ built.collapses, built.refused, built.cellError });
  }
  this->GetOutput()->SetLevels(std::move(levels));
  m_Report = std::move(report);
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
}
} // namespace bone

#endif
