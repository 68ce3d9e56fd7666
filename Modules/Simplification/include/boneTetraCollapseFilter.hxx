/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraCollapseFilter_hxx
#define boneTetraCollapseFilter_hxx

#include "boneMeshValidator.h"
#include "boneTetraCollapseFilter.h"

#include <algorithm>

namespace bone
{
template <typename TMesh>
TetraCollapseFilter<TMesh>::TetraCollapseFilter()
{
  this->SetNumberOfRequiredInputs(1);
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TMesh>
itk::DataObject::Pointer
TetraCollapseFilter<TMesh>::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType)
{
  return HierarchyType::New().GetPointer();
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::SetInput(const TMesh * mesh)
{
  this->SetNthInput(0, const_cast<TMesh *>(mesh));
}

template <typename TMesh>
const TMesh *
TetraCollapseFilter<TMesh>::GetInput() const
{
  return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryInput());
}

template <typename TMesh>
typename TetraCollapseFilter<TMesh>::HierarchyType *
TetraCollapseFilter<TMesh>::GetOutput()
{
  return itkDynamicCastInDebugMode<HierarchyType *>(this->GetPrimaryOutput());
}

template <typename TMesh>
const typename TetraCollapseFilter<TMesh>::HierarchyType *
TetraCollapseFilter<TMesh>::GetOutput() const
{
  return itkDynamicCastInDebugMode<const HierarchyType *>(this->GetPrimaryOutput());
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::SetLevels(const std::vector<IdType> & levels)
{
  if (levels != m_Levels)
  {
    m_Levels = levels;
    this->Modified();
  }
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::SetMaximumDensityErrors(const std::vector<double> & errors)
{
  if (errors != m_MaximumDensityErrors)
  {
    m_MaximumDensityErrors = errors;
    this->Modified();
  }
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::SetMaximumSurfaceDistances(const std::vector<double> & distances)
{
  if (distances != m_MaximumSurfaceDistances)
  {
    m_MaximumSurfaceDistances = distances;
    this->Modified();
  }
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (m_Levels.empty() && m_MaximumDensityErrors.empty() && m_MaximumSurfaceDistances.empty())
  {
    itkExceptionMacro("No levels are asked for; give numbers of tetrahedra (SetLevels), bounds on the density error "
                      "(SetMaximumDensityErrors) or on the distance of surfaces (SetMaximumSurfaceDistances).");
  }
  for (std::size_t i = 0; i < m_Levels.size(); ++i)
  {
    if (m_Levels[i] < 1 || (i > 0 && m_Levels[i] > m_Levels[i - 1]))
    {
      itkExceptionMacro("Level " << i + 2 << " is to have " << m_Levels[i]
                                 << " tetrahedra; levels must be positive and not ascend.");
    }
  }
  const auto checkBounds = [this](const std::vector<double> & bounds, const char * what) {
    for (std::size_t i = 0; i < bounds.size(); ++i)
    {
      if (!(bounds[i] >= 0) || (i > 0 && bounds[i] < bounds[i - 1]))
      {
        itkExceptionMacro("The " << what << " of level " << i + 2 << " is bounded by " << bounds[i]
                                 << "; bounds must not be negative and not descend.");
      }
    }
  };
  checkBounds(m_MaximumDensityErrors, "density error");
  checkBounds(m_MaximumSurfaceDistances, "surface distance");
  if (m_MaximumDegree > MaximumBernsteinDegree)
  {
    itkExceptionMacro("MaximumDegree is " << m_MaximumDegree << "; it must not be above " << MaximumBernsteinDegree
                                          << '.');
  }
  const auto check = [this](const char * name, double value, double upper) {
    if (!(value >= 0 && value <= upper))
    {
      itkExceptionMacro("" << name << " is " << value << "; it must lie between 0 and " << upper << ".");
    }
  };
  check("MaximumVolumeChange", m_MaximumVolumeChange, std::numeric_limits<double>::infinity());
  check("MinimumDihedralAngle", m_MinimumDihedralAngle, 1.23);
  check("MinimumCorticalDihedralAngle", m_MinimumCorticalDihedralAngle, 1.23);
  check("DensityWeight", m_DensityWeight, std::numeric_limits<double>::max());
  check("SurfaceWeight", m_SurfaceWeight, std::numeric_limits<double>::max());
  check("VolumeWeight", m_VolumeWeight, std::numeric_limits<double>::max());
}

template <typename TMesh>
CollapseParameters
TetraCollapseFilter<TMesh>::MakeParameters() const
{
  CollapseParameters parameters;
  parameters.densityWeight = m_DensityWeight;
  parameters.surfaceWeight = m_SurfaceWeight;
  parameters.volumeWeight = m_VolumeWeight;
  parameters.minimumAngle = m_MinimumDihedralAngle;
  parameters.minimumCorticalAngle = m_MinimumCorticalDihedralAngle;
  parameters.boundDistance = !m_MaximumSurfaceDistances.empty();
  parameters.maximumVolumeChange = m_MaximumVolumeChange;
  return parameters;
}

template <typename TMesh>
std::vector<LevelRequest>
TetraCollapseFilter<TMesh>::MakeRequests() const
{
  std::vector<LevelRequest> requests(
    std::max({ m_Levels.size(), m_MaximumDensityErrors.size(), m_MaximumSurfaceDistances.size() }));
  for (std::size_t i = 0; i < requests.size(); ++i)
  {
    requests[i].tetrahedra = i < m_Levels.size() ? m_Levels[i] : 0;
    requests[i].maximumDegree = m_MaximumDegree;
    if (i < m_MaximumSurfaceDistances.size())
    {
      requests[i].maximumSurfaceDistance = m_MaximumSurfaceDistances[i];
    }
    requests[i].maximumDensityError = i < m_MaximumDensityErrors.size() ? m_MaximumDensityErrors[i] : -1.0;
  }
  return requests;
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::GenerateData()
{
  MeshArrays input = this->GetInput()->GetArrays();
  const auto validation = ValidateMesh(input);
  if (input.tetrahedra.empty() || !validation.IsValid())
  {
    itkExceptionMacro("The input mesh cannot be simplified: " << (input.tetrahedra.empty() ? "it has no tetrahedra"
                                                                                           : validation.Summary()));
  }
  if (!input.HasDensity() && !m_MaximumDensityErrors.empty())
  {
    itkExceptionMacro("A bound on the density error is set, but the input mesh has no density; fit one first.");
  }
  std::vector<typename HierarchyType::Level> levels(1);
  levels[0].mesh = TMesh::New();
  levels[0].mesh->SetArrays(input);
  levels[0].stopReason = "input";
  m_Report.clear();

  const ParallelFor parallelFor = [this](std::size_t n, const std::function<void(std::size_t)> & body) {
    this->GetMultiThreader()->SetNumberOfWorkUnits(this->GetNumberOfWorkUnits());
    this->GetMultiThreader()->ParallelizeArray(
      0, n, [&body](itk::SizeValueType i) { body(i); }, nullptr);
  };
  HierarchyBuilder builder(std::move(input), this->MakeParameters(), parallelFor);
  const auto       requests = this->MakeRequests();
  for (std::size_t i = 0; i < requests.size(); ++i)
  {
    BuiltLevel                    built = builder.Next(requests[i], [&](double done) {
      this->UpdateProgress(static_cast<float>((i + done) / requests.size()));
      if (this->GetAbortGenerateData())
      {
        throw itk::ProcessAborted(__FILE__, __LINE__);
      }
    });
    typename HierarchyType::Level level;
    level.mesh = TMesh::New();
    level.mesh->SetArrays(std::move(built.mesh));
    level.parentPoint = std::move(built.parentPoint);
    level.densityErrorBound = requests[i].maximumDensityError;
    level.densityError = built.densityError;
    level.surfaceError = built.surfaceError;
    level.stopReason = built.stopReason;
    levels.push_back(std::move(level));
    m_Report.push_back({ built.collapses, built.refused });
  }
  this->GetOutput()->SetLevels(std::move(levels));
}

template <typename TMesh>
void
TetraCollapseFilter<TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Levels:";
  for (IdType n : m_Levels)
  {
    os << ' ' << n;
  }
  os << std::endl << indent << "MaximumDensityErrors:";
  for (double e : m_MaximumDensityErrors)
  {
    os << ' ' << e;
  }
  os << std::endl << indent << "MaximumSurfaceDistances:";
  for (double d : m_MaximumSurfaceDistances)
  {
    os << ' ' << d;
  }
  os << std::endl;
  os << indent << "MaximumDegree: " << m_MaximumDegree << std::endl;
  os << indent << "MaximumVolumeChange: " << m_MaximumVolumeChange << std::endl;
  os << indent << "MinimumDihedralAngle: " << m_MinimumDihedralAngle << std::endl;
  os << indent << "MinimumCorticalDihedralAngle: " << m_MinimumCorticalDihedralAngle << std::endl;
  os << indent << "DensityWeight: " << m_DensityWeight << std::endl;
  os << indent << "SurfaceWeight: " << m_SurfaceWeight << std::endl;
  os << indent << "VolumeWeight: " << m_VolumeWeight << std::endl;
}
} // namespace bone

#endif
