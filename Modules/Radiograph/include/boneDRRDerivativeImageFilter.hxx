/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDRRDerivativeImageFilter_hxx
#define boneDRRDerivativeImageFilter_hxx

#include "boneDRRDerivativeImageFilter.h"

#include <algorithm>
#include <cmath>

namespace bone
{
template <typename TMesh, typename TOutputImage>
void
DRRDerivativeImageFilter<TMesh, TOutputImage>::SetModes(RadiographModes modes)
{
  m_Modes = std::move(modes);
  const auto outputs = static_cast<unsigned int>(1 + m_Modes.Count());
  const auto before = static_cast<unsigned int>(this->GetNumberOfIndexedOutputs());
  this->SetNumberOfIndexedOutputs(outputs);
  for (unsigned int i = before; i < outputs; ++i)
  {
    this->SetNthOutput(i, this->MakeOutput(i));
  }
  this->Modified();
}

template <typename TMesh, typename TOutputImage>
void
DRRDerivativeImageFilter<TMesh, TOutputImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  if (this->GetGeometry(1) != nullptr || this->GetNumberOfIndexedOutputs() != 1 + m_Modes.Count())
  {
    itkExceptionMacro("There is a second view: use a filter for each.");
  }
}

template <typename TMesh, typename TOutputImage>
void
DRRDerivativeImageFilter<TMesh, TOutputImage>::ComputeIntegrals(const std::vector<XRayGeometry::View> & views,
                                                                const Execution &                       execution,
                                                                const std::vector<float *> &            integrals)
{
  const ProjectionModel &      model = this->GetModel(execution.Silent());
  const std::vector<Vector3> & points = model.Points();
  const MeshCells &            cells = model.Cells();
  for (std::size_t m = 0; m < m_Modes.shape.size(); ++m)
  {
    const auto & mode = m_Modes.shape[m];
    if (mode.size() != points.size() ||
        !std::all_of(mode.begin(), mode.end(), [](const Vector3 & v) { return v.allFinite(); }))
    {
      itkExceptionMacro("Shape mode " << m << " has " << mode.size() << " displacements; it must have " << points.size()
                                      << ", one a point, all finite.");
    }
  }
  for (std::size_t m = 0; m < m_Modes.density.size(); ++m)
  {
    const auto & mode = m_Modes.density[m];
    if (mode.size() != cells.coefficients.size() ||
        !std::all_of(mode.begin(), mode.end(), [](double value) { return std::isfinite(value); }))
    {
      itkExceptionMacro("Density mode " << m << " has " << mode.size() << " numbers; it must have "
                                        << cells.coefficients.size() << ", one a coefficient, all finite.");
    }
  }
  ProjectMeshDerivatives(model, views[0], m_Modes, execution, integrals);
}

template <typename TMesh, typename TOutputImage>
void
DRRDerivativeImageFilter<TMesh, TOutputImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Modes: " << (m_Modes.pose ? 6 : 0) << " of pose, " << m_Modes.shape.size() << " of shape, "
     << m_Modes.density.size() << " of density\n";
}
} // namespace bone

#endif
