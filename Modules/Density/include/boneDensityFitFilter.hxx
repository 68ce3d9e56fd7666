/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityFitFilter_hxx
#define boneDensityFitFilter_hxx

#include "boneContinuousDensity.h"
#include "boneDensityFitFilter.h"
#include "boneLinearSampler.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace bone
{
template <typename TImage, typename TMesh>
DensityFitFilter<TImage, TMesh>::DensityFitFilter()
{
  this->SetPrimaryInputName("Mesh");
  this->AddRequiredInputName("Image");
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TImage, typename TMesh>
itk::DataObject::Pointer
DensityFitFilter<TImage, TMesh>::MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType)
{
  return TMesh::New().GetPointer();
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::SetInput(const TMesh * mesh)
{
  this->SetNthInput(0, const_cast<TMesh *>(mesh));
}

template <typename TImage, typename TMesh>
const TMesh *
DensityFitFilter<TImage, TMesh>::GetInput() const
{
  return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryInput());
}

template <typename TImage, typename TMesh>
TMesh *
DensityFitFilter<TImage, TMesh>::GetOutput()
{
  return itkDynamicCastInDebugMode<TMesh *>(this->GetPrimaryOutput());
}

template <typename TImage, typename TMesh>
const TMesh *
DensityFitFilter<TImage, TMesh>::GetOutput() const
{
  return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryOutput());
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (m_Degree < 0 || m_Degree > MaximumBernsteinDegree)
  {
    itkExceptionMacro("Degree is " << m_Degree << ", but must be 0 to " << MaximumBernsteinDegree << ".");
  }
  if (!(m_Tikhonov >= 0 && std::isfinite(m_Tikhonov)))
  {
    itkExceptionMacro("Tikhonov is " << m_Tikhonov << ", but must be 0 or more and finite.");
  }
  if (m_Continuous && m_Degree < 1)
  {
    itkExceptionMacro("A continuous density needs Degree 1 or more: raise it, or turn Continuous off.");
  }
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::VerifyInputs(const MeshArrays & arrays) const
{
  if (arrays.tetrahedra.empty())
  {
    itkExceptionMacro("The input mesh has no tetrahedra.");
  }
  if (!std::all_of(arrays.points.begin(), arrays.points.end(), [](const Vector3 & p) { return p.allFinite(); }))
  {
    itkExceptionMacro("A point of the input mesh is not finite.");
  }
  if (this->GetImage()->GetBufferedRegion().GetNumberOfPixels() == 0)
  {
    itkExceptionMacro("The input 'Image' has no voxels.");
  }
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::FitBatches(const DensityFitPlan & plan, MeshArrays & arrays)
{
  const TImage *                                  image = this->GetImage();
  const VoxelGrid                                 grid = MakeVoxelGrid(*image, image->GetBufferedRegion());
  const Eigen::Matrix3d                           toIndex = grid.axes.inverse();
  const LinearSampler<typename TImage::PixelType> sampler(image->GetBufferPointer(), grid.size);
  const Vector3                                   last(grid.size[0] - 0.5, grid.size[1] - 0.5, grid.size[2] - 0.5);
  const std::size_t                               count = BernsteinCount(m_Degree);
  const auto &                                    batches = plan.GetBatches();
  std::vector<std::size_t>                        outside(batches.size(), 0);
  std::vector<char>                               finite(batches.size(), 1);

  const auto fitBatch = [&](itk::SizeValueType b) {
    const DensityFitKernel & kernel = *batches[b].kernel;
    const auto &             pattern = kernel.SamplePoints();
    const std::size_t        cells = batches[b].tetrahedra.size(), samples = pattern.size();
    std::vector<double>      values(cells * samples), fitted(cells * count);
    for (std::size_t c = 0; c < cells; ++c)
    {
      const Id4 &                 v = arrays.tetrahedra[batches[b].tetrahedra[c]];
      Eigen::Matrix<double, 3, 4> vertices;
      for (int i = 0; i < 4; ++i)
      {
        vertices.col(i) = toIndex * (arrays.points[v[i]] - grid.origin);
      }
      for (std::size_t s = 0; s < samples; ++s)
      {
        const Vector3 index = vertices * pattern[s];
        values[c * samples + s] = sampler(index);
        outside[b] += (index.array() < -0.5).any() || (index.array() > last.array()).any() ? 1 : 0;
      }
    }
    finite[b] = std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); }) ? 1 : 0;
    kernel.FitMany(cells, values.data(), fitted.data());
    for (std::size_t c = 0; c < cells; ++c)
    {
      std::copy_n(&fitted[c * count], count, &arrays.coefficients[batches[b].tetrahedra[c] * count]);
    }
  };
  this->GetMultiThreader()->SetNumberOfWorkUnits(this->GetNumberOfWorkUnits());
  this->GetMultiThreader()->ParallelizeArray(0, batches.size(), fitBatch, this);

  const std::size_t total = std::accumulate(outside.begin(), outside.end(), std::size_t{ 0 });
  m_OutsideFraction = static_cast<double>(total) / static_cast<double>(plan.GetNumberOfSamples());
  if (m_OutsideFraction >= 1)
  {
    itkExceptionMacro("The mesh lies wholly outside the input 'Image': are both of the same scan, and in LPS mm?");
  }
  if (std::find(finite.begin(), finite.end(), 0) != finite.end())
  {
    itkExceptionMacro("The input 'Image' has voxels in the mesh that are not finite: repair it first.");
  }
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::GenerateData()
{
  MeshArrays arrays = this->GetInput()->GetArrays();
  this->VerifyInputs(arrays);
  double voxelVolume = 1;
  for (unsigned int axis = 0; axis < 3; ++axis)
  {
    voxelVolume *= this->GetImage()->GetSpacing()[axis];
  }
  const std::size_t cells = arrays.tetrahedra.size();
  arrays.maximumDegree = m_Degree;
  arrays.quantity = m_Quantity;
  arrays.degree.assign(cells, m_Degree);
  arrays.coefficients.assign(cells * BernsteinCount(m_Degree), 0.0);
  this->FitBatches(DensityFitPlan(arrays, voxelVolume, m_Degree, m_Tikhonov), arrays);
  m_NumberOfFreeCoefficients = arrays.coefficients.size();
  if (m_Continuous)
  {
    const DensityLoop loop = [this](std::size_t count, const std::function<void(std::size_t)> & body) {
      this->GetMultiThreader()->ParallelizeArray(0, count, body, nullptr);
      if (this->GetAbortGenerateData())
      {
        throw itk::ProcessAborted(__FILE__, __LINE__);
      }
    };
    try
    {
      m_NumberOfFreeCoefficients = MakeDensityContinuous(arrays, loop).freeCoefficients;
    }
    catch (const std::logic_error & error)
    {
      itkExceptionMacro("" << error.what());
    }
  }
  TMesh * output = this->GetOutput();
  output->SetArrays(std::move(arrays));
  output->SetBufferedRegion(output->GetRequestedRegion());
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Degree: " << m_Degree << '\n';
  os << indent << "Continuous: " << (m_Continuous ? "On" : "Off") << '\n';
  os << indent << "Tikhonov: " << m_Tikhonov << '\n';
  os << indent << "Quantity: " << DensityQuantityName(m_Quantity) << '\n';
  os << indent << "OutsideFraction: " << m_OutsideFraction << '\n';
  os << indent << "NumberOfFreeCoefficients: " << m_NumberOfFreeCoefficients << '\n';
}
} // namespace bone

#endif
