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
  ProjectMesh(GetModel(execution.Silent()), views, execution, integrals);
}
} // namespace bone

#endif
