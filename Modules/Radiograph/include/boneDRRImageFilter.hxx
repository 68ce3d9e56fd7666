/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDRRImageFilter_hxx
#define boneDRRImageFilter_hxx

#include "boneDRRImageFilter.h"

#include <algorithm>
#include <cmath>

namespace bone
{
template <typename TMesh, typename TOutputImage>
DRRImageFilter<TMesh, TOutputImage>::DRRImageFilter()
{
  this->SetPrimaryInputName("Mesh");
}

template <typename TMesh, typename TOutputImage>
void
DRRImageFilter<TMesh, TOutputImage>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  const auto conversion = this->GetHUToAttenuation();
  if (conversion != HUToAttenuation::None && conversion != HUToAttenuation::WaterScaled)
  {
    itkExceptionMacro("HUToAttenuation is "
                      << conversion
                      << ", which is no line: a polynomial would not stay one. Convert the CT and fit the model to the "
                         "result (AttenuationImageFilter), then leave it at None.");
  }
  if (m_MinimumRegion > m_MaximumRegion)
  {
    itkExceptionMacro("MinimumRegion (" << m_MinimumRegion << ") is above MaximumRegion (" << m_MaximumRegion
                                        << "): no tetrahedron would count.");
  }
}

template <typename TMesh, typename TOutputImage>
void
DRRImageFilter<TMesh, TOutputImage>::VerifyMesh(const std::vector<Vector3> & points) const
{
  const MeshArrays & cells = this->GetInput()->GetCells();
  if (cells.tetrahedra.empty())
  {
    itkExceptionMacro("The mesh has no tetrahedra.");
  }
  if (!cells.HasDensity())
  {
    itkExceptionMacro("The mesh has no density: fit one to a CT first (DensityFitFilter).");
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(points.begin(), points.end(), [](const Vector3 & p) { return p.allFinite(); }) ||
      !std::all_of(cells.coefficients.begin(), cells.coefficients.end(), finite))
  {
    itkExceptionMacro("A point or a density coefficient of the mesh is not finite.");
  }
  const bool restricted =
    m_MinimumRegion > std::numeric_limits<int>::min() || m_MaximumRegion < std::numeric_limits<int>::max();
  if (restricted && cells.region.empty())
  {
    itkExceptionMacro("The mesh has no regions to choose from: leave MinimumRegion and MaximumRegion alone.");
  }
  const auto quantity = cells.quantity;
  if (this->GetHUToAttenuation() != HUToAttenuation::None && quantity != DensityQuantity::HounsfieldUnit &&
      quantity != DensityQuantity::Unknown)
  {
    itkExceptionMacro("HUToAttenuation is " << this->GetHUToAttenuation() << ", but the mesh's density is in "
                                            << DensityQuantityName(quantity) << ": set it to None.");
  }
}

template <typename TMesh, typename TOutputImage>
void
DRRImageFilter<TMesh, TOutputImage>::ComputeIntegrals(const std::vector<XRayGeometry::View> & views,
                                                      const std::vector<float *> &            integrals)
{
  const TMesh *        mesh = this->GetInput();
  std::vector<Vector3> points(mesh->GetNumberOfPoints());
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    const auto & x = mesh->GetPoints()->ElementAt(p);
    points[p] = Vector3(x[0], x[1], x[2]);
  }
  this->VerifyMesh(points);

  const auto            conversion = this->GetCurve().Line();
  MeshRadiographOptions options{ m_MinimumRegion, m_MaximumRegion, conversion.scale, conversion.offset };
  const LoopRunner      loops = this->MakeLoops();
  m_MeanCellsPassed = 0.0;
  if (m_Method == DRRMethod::Projection)
  {
    ProjectMesh(points, mesh->GetCells(), views, options, loops, integrals);
    return;
  }
  double      sum = 0.0;
  std::size_t hit = 0;
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    std::vector<std::int32_t> passed(static_cast<std::size_t>(views[i].size[0]) * views[i].size[1]);
    WalkMesh(points, mesh->GetCells(), views[i], options, loops, integrals[i], passed.data());
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
  os << indent << "Method: " << m_Method << '\n';
  os << indent << "MinimumRegion: " << m_MinimumRegion << '\n';
  os << indent << "MaximumRegion: " << m_MaximumRegion << '\n';
  os << indent << "MeanCellsPassed: " << m_MeanCellsPassed << '\n';
}
} // namespace bone

#endif
