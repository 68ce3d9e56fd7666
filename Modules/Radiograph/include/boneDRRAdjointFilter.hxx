/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDRRAdjointFilter_hxx
#define boneDRRAdjointFilter_hxx

#include "boneDRRAdjointFilter.h"

#include <itkImageRegionConstIterator.h>

#include <algorithm>
#include <cmath>

namespace bone
{
template <typename TMesh, typename TImage>
DRRAdjointFilter<TMesh, TImage>::DRRAdjointFilter()
{
  this->SetPrimaryInputName("Mesh");
  this->AddRequiredInputName("Image");
  this->AddRequiredInputName("Geometry");
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
  this->Superclass::SetOutput("PointGradient", PointGradientType::New());
}

template <typename TMesh, typename TImage>
void
DRRAdjointFilter<TMesh, TImage>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (!(m_WaterAttenuation > 0) || !std::isfinite(m_WaterAttenuation))
  {
    itkExceptionMacro("WaterAttenuation is " << m_WaterAttenuation << " per mm; it must be positive.");
  }
}

template <typename TMesh, typename TImage>
std::vector<float>
DRRAdjointFilter<TMesh, TImage>::GetWeights(unsigned int view) const
{
  const TImage * image = this->GetImage(view);
  const auto *   geometry = this->GetGeometry(view);
  if (image == nullptr || geometry == nullptr)
  {
    itkExceptionMacro("View " << view << " has no " << (image == nullptr ? "Image." : "Geometry."));
  }
  const auto   region = image->GetLargestPossibleRegion();
  const auto & size = geometry->GetView().size;
  if (region.GetSize(0) != static_cast<itk::SizeValueType>(size[0]) ||
      region.GetSize(1) != static_cast<itk::SizeValueType>(size[1]) ||
      region.GetNumberOfPixels() != region.GetSize(0) * region.GetSize(1))
  {
    itkExceptionMacro("Image " << view << " has size " << region.GetSize() << ", but its view has " << size[0]
                               << " columns and " << size[1] << " rows.");
  }
  std::vector<float>                    weights;
  itk::ImageRegionConstIterator<TImage> pixel(image, region);
  for (weights.reserve(region.GetNumberOfPixels()); !pixel.IsAtEnd(); ++pixel)
  {
    weights.push_back(static_cast<float>(pixel.Get()));
  }
  if (!std::all_of(weights.begin(), weights.end(), [](float value) { return std::isfinite(value); }))
  {
    itkExceptionMacro("Image " << view << " has a value that is not finite.");
  }
  return weights;
}

template <typename TMesh, typename TImage>
void
DRRAdjointFilter<TMesh, TImage>::GenerateData()
{
  MeshArrays                  arrays = this->GetInput()->GetArrays();
  const auto                  line = AttenuationCurve{ m_HUToAttenuation, m_WaterAttenuation, 0.0, {} }.Line();
  const MeshRadiographOptions options{ m_MinimumRegion, m_MaximumRegion, line.scale, line.offset };
  const std::string           obstacle = FindObstacle(arrays.points, arrays, options, m_HUToAttenuation);
  if (!obstacle.empty())
  {
    itkExceptionMacro(<< obstacle);
  }
  const auto loop = [this](std::size_t count, const std::function<void(std::size_t)> & body) {
    this->GetMultiThreader()->SetNumberOfWorkUnits(this->GetNumberOfWorkUnits());
    this->GetMultiThreader()->ParallelizeArray(
      0, count, [&](itk::SizeValueType i) { body(i); }, nullptr);
  };
  std::vector<double>  sum(arrays.coefficients.size(), 0.0), coefficients(sum.size());
  std::vector<Vector3> gradient(arrays.points.size(), Vector3(Vector3::Zero())), points(gradient.size());
  for (unsigned int view = 0; view == 0 || this->GetGeometry(view) != nullptr || this->GetImage(view) != nullptr;
       ++view)
  {
    const std::vector<float> weights = this->GetWeights(view);
    BackprojectToMesh(arrays.points,
                      arrays,
                      this->GetGeometry(view)->GetView(),
                      options,
                      { loop, loop },
                      weights.data(),
                      coefficients.data(),
                      points.data());
    std::transform(sum.begin(), sum.end(), coefficients.begin(), sum.begin(), std::plus<double>());
    std::transform(gradient.begin(), gradient.end(), points.begin(), gradient.begin(), std::plus<Vector3>());
  }
  arrays.coefficients = std::move(sum);
  arrays.quantity = DensityQuantity::Unknown;
  this->GetOutput()->SetArrays(std::move(arrays));
  static_cast<PointGradientType *>(this->Superclass::GetOutput("PointGradient"))->Set(gradient);
  this->UpdateProgress(1.0f);
}

template <typename TMesh, typename TImage>
void
DRRAdjointFilter<TMesh, TImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "MinimumRegion: " << m_MinimumRegion << '\n';
  os << indent << "MaximumRegion: " << m_MaximumRegion << '\n';
  os << indent << "HUToAttenuation: " << m_HUToAttenuation << '\n';
  os << indent << "WaterAttenuation: " << m_WaterAttenuation << '\n';
}
} // namespace bone

#endif
