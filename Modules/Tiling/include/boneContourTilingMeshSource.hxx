/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourTilingMeshSource_hxx
#define boneContourTilingMeshSource_hxx

#include "boneContourTilingMeshSource.h"

#include <itkLinearInterpolateImageFunction.h>

#include <limits>

namespace bone
{
template <typename TMesh, typename TImage>
ContourTilingMeshSource<TMesh, TImage>::ContourTilingMeshSource()
{
  this->SetPrimaryInputName("Contours");
  this->AddRequiredInputName("Contours");
  this->AddOptionalInputName("DensityImage");
}

template <typename TMesh, typename TImage>
void
ContourTilingMeshSource<TMesh, TImage>::SetMetricObject(std::shared_ptr<const TilingMetric> metric)
{
  if (metric != m_MetricObject)
  {
    m_MetricObject = std::move(metric);
    this->Modified();
  }
}

template <typename TMesh, typename TImage>
void
ContourTilingMeshSource<TMesh, TImage>::SetCorrespondence(std::shared_ptr<const ContourCorrespondence> correspondence)
{
  if (correspondence != m_Correspondence)
  {
    m_Correspondence = std::move(correspondence);
    this->Modified();
  }
}

template <typename TMesh, typename TImage>
void
ContourTilingMeshSource<TMesh, TImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  if (!m_MetricObject && m_Parameters.metric == TilingMetricKind::Density && this->GetDensityImage() == nullptr)
  {
    itkExceptionMacro("The metric 'density' needs the input 'DensityImage': set it, or choose another metric.");
  }
}

template <typename TMesh, typename TImage>
DensitySampler
ContourTilingMeshSource<TMesh, TImage>::MakeSampler() const
{
  const TImage * image = this->GetDensityImage();
  if (image == nullptr)
  {
    return {};
  }
  using Interpolator = itk::LinearInterpolateImageFunction<TImage, double>;
  auto interpolator = Interpolator::New();
  interpolator->SetInputImage(image);
  return [interpolator](const Vector3 & p) {
    typename Interpolator::PointType point;
    point[0] = p.x();
    point[1] = p.y();
    point[2] = p.z();
    return interpolator->IsInsideBuffer(point) ? interpolator->Evaluate(point)
                                               : std::numeric_limits<double>::quiet_NaN();
  };
}

template <typename TMesh, typename TImage>
void
ContourTilingMeshSource<TMesh, TImage>::GenerateData()
{
  TilingGuide guide;
  guide.metric = m_MetricObject ? m_MetricObject : MakeTilingMetric(m_Parameters.metric, this->MakeSampler());
  guide.correspondence = m_Correspondence;
  guide.branching = m_Parameters.branching;
  this->GetInput()->Verify();
  try
  {
    this->SetResult(TileContours(*this->GetInput(), guide, m_Report, Execution(this)));
  }
  catch (const std::runtime_error & error)
  {
    itkExceptionMacro("The input 'Contours' cannot be tiled: " << error.what());
  }
}

template <typename TMesh, typename TImage>
void
ContourTilingMeshSource<TMesh, TImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "MetricObject: " << (m_MetricObject ? "set" : "none") << '\n';
  os << indent << "Correspondence: " << (m_Correspondence ? "given" : "found") << '\n';
  os << indent << "Slabs: " << m_Report.slabs << '\n';
}
} // namespace bone

#endif
