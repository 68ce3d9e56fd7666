/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtlasVolumeRegistration_hxx
#define boneAtlasVolumeRegistration_hxx

#include "boneAtlasVolumeRegistration.h"
#include "boneDensityFitFilter.h"
#include "boneDensityRaster.h"
#include "boneVolumeDensity.h"

#include <cmath>

namespace bone
{
template <typename TImage, typename TMesh, typename TLabelImage>
AtlasVolumeRegistration<TImage, TMesh, TLabelImage>::AtlasVolumeRegistration()
{
  this->SetPrimaryInputName("Image");
  this->SetNumberOfRequiredInputs(1);
  this->AddRequiredInputName("Model");
  this->SetNumberOfRequiredOutputs(2);
  this->SetNthOutput(1, this->MakeOutput(1));
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
AtlasVolumeRegistration<TImage, TMesh, TLabelImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
AtlasVolumeRegistration<TImage, TMesh, TLabelImage>::GenerateInputRequestedRegion()
{
  Superclass::GenerateInputRequestedRegion();
  const_cast<TImage *>(this->GetImage())->SetRequestedRegionToLargestPossibleRegion();
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
AtlasVolumeRegistration<TImage, TMesh, TLabelImage>::VerifyInputs() const
{
  const MeshArrays & mean = this->GetModel()->GetContent().mean;
  if (!mean.HasDensity())
  {
    itkExceptionMacro("The input 'Model' has no density, which the bone is searched for by: train it with models that "
                      "have one.");
  }
  if (mean.quantity != DensityQuantity::HounsfieldUnit && mean.quantity != DensityQuantity::Unknown)
  {
    itkExceptionMacro("The input 'Model' has a density that is not in HU, and a CT is compared with it: train it with "
                      "models fitted to CTs in HU.");
  }
  const TImage * image = this->GetImage();
  const auto     size = image->GetBufferedRegion().GetSize();
  if (size[0] < 2 || size[1] < 2 || size[2] < 2)
  {
    itkExceptionMacro("The input 'Image' has " << size[0] << " x " << size[1] << " x " << size[2]
                                               << " voxels; two along each axis are the least.");
  }
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
AtlasVolumeRegistration<TImage, TMesh, TLabelImage>::FitDensity(const VolumeView & ct)
{
  auto found = TMesh::New();
  found->SetArrays(m_Result.mesh);
  auto fit = DensityFitFilter<TImage, TMesh>::New();
  fit->SetInput(found);
  fit->SetImage(this->GetImage());
  fit->SetDegree(m_Result.mesh.maximumDegree);
  fit->SetNumberOfWorkUnits(this->GetNumberOfWorkUnits());
  fit->Update();
  TakeVolumeDensity(this->GetModel()->GetContent(), ct, this->GetParameters(), fit->GetOutput()->GetArrays(), m_Result);
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
AtlasVolumeRegistration<TImage, TMesh, TLabelImage>::FillLabels(const VoxelGrid & grid, const Execution & execution)
{
  TLabelImage * labels = this->GetLabelImage();
  labels->CopyInformation(this->GetImage());
  labels->SetRegions(this->GetImage()->GetBufferedRegion());
  labels->Allocate();
  const MeshArrays &  mesh = m_Result.mesh;
  const DensityRaster raster(mesh, grid);
  const std::size_t   slice = static_cast<std::size_t>(grid.size[0]) * grid.size[1];
  auto * const        buffer = labels->GetBufferPointer();
  execution.For(static_cast<std::size_t>(grid.size[2]), [&](std::size_t k) {
    std::vector<double> values(slice);
    std::vector<IdType> cells(slice);
    raster.FillSlice(static_cast<int>(k), 0.0, values.data(), cells.data());
    for (std::size_t i = 0; i < slice; ++i)
    {
      const int region = cells[i] < 0 ? 0 : mesh.region.empty() ? 1 : mesh.region[static_cast<std::size_t>(cells[i])];
      buffer[k * slice + i] = static_cast<typename TLabelImage::PixelType>(region);
    }
  });
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
AtlasVolumeRegistration<TImage, TMesh, TLabelImage>::GenerateData()
{
  this->VerifyInputs();
  const TImage *     image = this->GetImage();
  const VoxelGrid    grid = MakeVoxelGrid(*image, image->GetBufferedRegion());
  std::vector<float> copied;
  const float *      voxels = nullptr;
  if constexpr (std::is_same_v<typename TImage::PixelType, float>)
  {
    voxels = image->GetBufferPointer();
  }
  else
  {
    copied.assign(image->GetBufferPointer(), image->GetBufferPointer() + grid.NumberOfVoxels());
    voxels = copied.data();
  }
  if (!std::all_of(voxels, voxels + grid.NumberOfVoxels(), [](float v) { return std::isfinite(v); }))
  {
    itkExceptionMacro("The input 'Image' has voxels that are not finite: repair it first.");
  }
  const Execution  execution(this);
  const VolumeView ct(grid, voxels);
  try
  {
    m_Result = RegisterVolume(this->GetModel()->GetContent(), ct, this->GetParameters(), execution.Part(0.0, 0.9));
  }
  catch (const std::invalid_argument & error)
  {
    itkExceptionMacro("" << error.what());
  }
  if (m_Result.quality == RegistrationQuality::Failed)
  {
    itkExceptionMacro("The bone of the input 'Model' was not found in the input 'Image': of the best place's surface "
                      << std::lround(100.0 * m_Result.support.supported)
                      << " % lie on edges of the CT. Does the CT show it, is it in HU, is the bone of the other side "
                         "(Mirror), or too little of it in the CT?");
  }
  if (m_Result.inverted > 0)
  {
    itkExceptionMacro("The shape found inverts " << m_Result.inverted
                                                 << " tetrahedra that cannot be repaired: it is too far from the mean "
                                                    "of the input 'Model'. Use fewer SmoothModes.");
  }
  this->FitDensity(ct);
  this->FillLabels(grid, execution.Part(0.95, 1.0));
  this->SetResult(MeshArrays(m_Result.mesh));
}

template <typename TImage, typename TMesh, typename TLabelImage>
void
AtlasVolumeRegistration<TImage, TMesh, TLabelImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, this->GetParameters());
  os << indent << "Quality: " << ParameterText(m_Result.quality) << '\n';
  os << indent << "Supported: " << m_Result.support.supported << '\n';
  os << indent << "Mirrored: " << m_Result.mirrored << '\n';
  os << indent << "Coefficients: " << m_Result.coefficients.transpose() << '\n';
}
} // namespace bone

#endif
