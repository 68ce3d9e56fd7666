/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDRRImageFilter_hxx
#define boneDRRImageFilter_hxx

#include "boneDRRImageFilter.h"

namespace bone
{
template <typename TMesh, typename TOutputImage>
DRRImageFilter<TMesh, TOutputImage>::DRRImageFilter()
{
  this->SetPrimaryInputName("Mesh");
}

template <typename TMesh, typename TOutputImage>
void
DRRImageFilter<TMesh, TOutputImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
}

template <typename TMesh, typename TOutputImage>
MeshRadiographParameters
DRRImageFilter<TMesh, TOutputImage>::GetMeshRadiographParameters() const
{
  return MakeMeshRadiographParameters(
    m_Parameters.minimumRegion, m_Parameters.maximumRegion, this->GetHUToAttenuation(), this->GetWaterAttenuation());
}

template <typename TMesh, typename TOutputImage>
std::vector<Vector3>
DRRImageFilter<TMesh, TOutputImage>::GetVerifiedPoints() const
{
  const TMesh *        mesh = this->GetInput();
  std::vector<Vector3> points = CopyPoints(*mesh);
  const std::string    obstacle =
    FindObstacle(points, mesh->GetCells(), GetMeshRadiographParameters(), this->GetHUToAttenuation());
  if (!obstacle.empty())
  {
    itkExceptionMacro(<< obstacle);
  }
  return points;
}

template <typename TMesh, typename TOutputImage>
const ProjectionModel &
DRRImageFilter<TMesh, TOutputImage>::GetModel(const Execution & execution)
{
  const TMesh *                  mesh = this->GetInput();
  const MeshRadiographParameters parameters = GetMeshRadiographParameters();
  if (m_Kept.model == nullptr || m_Kept.mesh != mesh || m_Kept.time != mesh->GetMTime() ||
      m_Kept.conversion != this->GetHUToAttenuation() || m_Kept.model->Parameters() != parameters)
  {
    m_Kept.model.reset();
    m_Kept.mesh = nullptr;
    m_Kept.points = GetVerifiedPoints();
    m_Kept.model = std::make_unique<const ProjectionModel>(m_Kept.points, mesh->GetCells(), parameters, execution);
    m_Kept.mesh = mesh;
    m_Kept.time = mesh->GetMTime();
    m_Kept.conversion = this->GetHUToAttenuation();
  }
  return *m_Kept.model;
}

template <typename TMesh, typename TOutputImage>
void
DRRImageFilter<TMesh, TOutputImage>::ComputeIntegrals(const std::vector<XRayGeometry::View> & views,
                                                      const Execution &                       execution,
                                                      const std::vector<float *> &            integrals)
{
  m_MeanCellsPassed = 0.0;
  if (m_Parameters.method == DRRMethod::Projection)
  {
    ProjectMesh(GetModel(execution.Silent()), views, execution, integrals);
    return;
  }
  const TMesh *                  mesh = this->GetInput();
  const std::vector<Vector3>     points = GetVerifiedPoints();
  const MeshRadiographParameters parameters = GetMeshRadiographParameters();
  const auto                     count = static_cast<double>(views.size());
  double                         sum = 0.0;
  std::size_t                    hit = 0;
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    std::vector<std::int32_t> passed(static_cast<std::size_t>(views[i].size[0]) * views[i].size[1]);
    const Execution           part = execution.Part(static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
    WalkMesh(points, mesh->GetCells(), views[i], parameters, part, integrals[i], passed.data());
    for (std::int32_t cells : passed)
    {
      sum += cells;
      hit += cells > 0 ? 1 : 0;
    }
  }
  m_MeanCellsPassed = hit > 0 ? sum / static_cast<double>(hit) : 0.0;
}

template <typename TMesh, typename TOutputImage>
void
DRRImageFilter<TMesh, TOutputImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "MeanCellsPassed: " << m_MeanCellsPassed << '\n';
}
} // namespace bone

#endif
