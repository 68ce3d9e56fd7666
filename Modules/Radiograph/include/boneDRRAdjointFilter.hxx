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
  this->AddRequiredInputName("Image");
  this->AddRequiredInputName("Geometry");
  this->itk::ProcessObject::SetOutput("PointGradient", PointGradientType::New());
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
  MeshArrays                     arrays = this->GetInput()->GetArrays();
  const DRRAdjointParameters &   p = this->m_Parameters;
  const MeshRadiographParameters parameters =
    MakeMeshRadiographParameters(p.minimumRegion, p.maximumRegion, p.huToAttenuation, p.waterAttenuation);
  const std::string obstacle = FindObstacle(arrays.points, arrays, parameters, p.huToAttenuation);
  if (!obstacle.empty())
  {
    itkExceptionMacro(<< obstacle);
  }
  const Execution execution(this);
  unsigned int    views = 1;
  while (this->GetGeometry(views) != nullptr || this->GetImage(views) != nullptr)
  {
    ++views;
  }
  const ProjectionModel model(arrays.points, arrays, parameters, execution.Silent(), views > 1);
  std::vector<double>   sum(arrays.coefficients.size(), 0.0), coefficients(sum.size());
  std::vector<Vector3>  gradient(arrays.points.size(), Vector3(Vector3::Zero())), points(gradient.size());
  for (unsigned int view = 0; view < views; ++view)
  {
    const std::vector<float> weights = this->GetWeights(view);
    BackprojectToMesh(model,
                      this->GetGeometry(view)->GetView(),
                      execution.Part(static_cast<double>(view) / views, (view + 1.0) / views),
                      weights.data(),
                      coefficients.data(),
                      points.data());
    std::transform(sum.begin(), sum.end(), coefficients.begin(), sum.begin(), std::plus<double>());
    std::transform(gradient.begin(), gradient.end(), points.begin(), gradient.begin(), std::plus<Vector3>());
  }
  arrays.coefficients = std::move(sum);
  arrays.quantity = DensityQuantity::Unknown;
  this->SetResult(std::move(arrays));
  static_cast<PointGradientType *>(this->itk::ProcessObject::GetOutput("PointGradient"))->Set(gradient);
  this->UpdateProgress(1.0f);
}
} // namespace bone

#endif
