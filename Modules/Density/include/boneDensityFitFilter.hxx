/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityFitFilter_hxx
#define boneDensityFitFilter_hxx

#include "boneContinuousDensity.h"
#include "boneCubicSampler.h"
#include "boneDensityFitFilter.h"
#include "boneLinearSampler.h"
#include "boneQuadraticSampler.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <stdexcept>

namespace bone
{
/** A sampler of many places from one of a single place. */
template <typename TSampler>
ImageSampler
SamplerOf(TSampler sampler)
{
  return [sampler = std::move(sampler)](const Vector3 * indices, std::size_t count, double * values) {
    for (std::size_t i = 0; i < count; ++i)
    {
      values[i] = sampler(indices[i]);
    }
  };
}

template <typename TImage, typename TMesh>
DensityFitFilter<TImage, TMesh>::DensityFitFilter()
{
  this->SetPrimaryInputName("Mesh");
  this->AddRequiredInputName("Image");
  this->AddOptionalInputName("Weights");
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
  const std::pair<const char *, double> notNegative[] = { { "VoxelWeight", m_VoxelWeight },
                                                          { "SurfaceMargin", m_SurfaceMargin },
                                                          { "InterfaceMargin", m_InterfaceMargin },
                                                          { "MaximumError", m_MaximumError } };
  for (const auto & [name, value] : notNegative)
  {
    if (!(value >= 0 && std::isfinite(value)))
    {
      itkExceptionMacro("" << name << " is " << value << ", but must be 0 or more and finite.");
    }
  }
  if (!(m_OvershootLimit >= 0))
  {
    itkExceptionMacro("OvershootLimit is " << m_OvershootLimit << ", but must be 0 or more.");
  }
  if (m_Continuous && m_MaximumError > 0)
  {
    itkExceptionMacro("A continuous density has one degree: set MaximumError to 0, or turn Continuous off.");
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
auto
DensityFitFilter<TImage, TMesh>::WithoutHeldOutVoxels(const VoxelGrid & grid) const -> std::vector<RealType>
{
  const auto *          buffer = this->GetImage()->GetBufferPointer();
  std::vector<RealType> values(buffer, buffer + grid.NumberOfVoxels());
  for (int k = 0; k < grid.size[2]; ++k)
  {
    for (int j = 0; j < grid.size[1]; ++j)
    {
      for (int i = 0; i < grid.size[0]; ++i)
      {
        if (!IsHeldOut(i, j, k))
        {
          continue;
        }
        const std::size_t at = (static_cast<std::size_t>(k) * grid.size[1] + j) * grid.size[0] + i;
        double            sum = 0;
        int               found = 0;
        std::size_t       stride = 1;
        for (const auto & [place, size] : { std::pair(i, grid.size[0]), { j, grid.size[1] }, { k, grid.size[2] } })
        {
          sum += place > 0 ? static_cast<double>(buffer[at - stride]) : 0.0;
          sum += place + 1 < size ? static_cast<double>(buffer[at + stride]) : 0.0;
          found += (place > 0 ? 1 : 0) + (place + 1 < size ? 1 : 0);
          stride *= size;
        }
        values[at] = static_cast<RealType>(found > 0 ? sum / found : static_cast<double>(buffer[at]));
      }
    }
  }
  return values;
}

template <typename TImage, typename TMesh>
template <typename TPixel>
ImageSampler
DensityFitFilter<TImage, TMesh>::MakeInterpolator(const TPixel *     buffer,
                                                  const VoxelGrid &  grid,
                                                  const MeshArrays & arrays) const
{
  if (m_Interpolator == DensityInterpolator::Linear)
  {
    return SamplerOf(QuadraticSampler<TPixel>(buffer, grid.size));
  }
  // The spline of the block around the mesh; a voxel's influence falls to a quarter with each step away from it.
  const Eigen::Matrix3d toIndex = grid.axes.inverse();
  std::array<int, 3>    first, size;
  for (int axis = 0; axis < 3; ++axis)
  {
    double lower = grid.size[axis], upper = -1;
    for (const Vector3 & p : arrays.points)
    {
      const double x = toIndex.row(axis).dot(p - grid.origin);
      lower = std::min(lower, x);
      upper = std::max(upper, x);
    }
    constexpr double margin = 16;
    const double     last = grid.size[axis] - 1.0;
    first[axis] = static_cast<int>(std::clamp(std::floor(lower) - margin, 0.0, last));
    size[axis] = static_cast<int>(std::clamp(std::ceil(upper) + margin, 0.0, last)) - first[axis] + 1;
  }
  std::vector<float> block;
  block.reserve(static_cast<std::size_t>(size[0]) * size[1] * size[2]);
  for (int k = 0; k < size[2]; ++k)
  {
    for (int j = 0; j < size[1]; ++j)
    {
      const TPixel * row =
        buffer + (static_cast<std::size_t>(first[2] + k) * grid.size[1] + first[1] + j) * grid.size[0] + first[0];
      std::transform(row, row + size[0], std::back_inserter(block), [](TPixel x) { return static_cast<float>(x); });
    }
  }
  return SamplerOf(
    [sampler = std::make_shared<CubicSampler>(std::move(block), size),
     shift = Vector3(first[0], first[1], first[2])](const Vector3 & index) { return (*sampler)(index - shift); });
}

template <typename TImage, typename TMesh>
ImageSampler
DensityFitFilter<TImage, TMesh>::MakeWeights(const VoxelGrid & grid) const
{
  const TImage * weights = this->GetWeights();
  if (weights == nullptr)
  {
    return {};
  }
  const VoxelGrid       own = MakeVoxelGrid(*weights, weights->GetBufferedRegion());
  const Eigen::Matrix3d toOwn = own.axes.inverse() * grid.axes;
  const Vector3         shift = own.axes.inverse() * (grid.origin - own.origin);
  const auto *          buffer = weights->GetBufferPointer();
  if (std::any_of(buffer, buffer + own.NumberOfVoxels(), [](auto w) { return !(w >= 0 && std::isfinite(w)); }))
  {
    itkExceptionMacro("The input 'Weights' has values that are negative or not finite: weights must be 0 or more.");
  }
  return SamplerOf([sampler = LinearSampler<typename TImage::PixelType>(buffer, own.size), toOwn, shift](
                     const Vector3 & index) { return sampler(toOwn * index + shift); });
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::Fit(MeshArrays & arrays)
{
  using PixelType = typename TImage::PixelType;
  const TImage *  image = this->GetImage();
  DensityFitImage from;
  from.grid = MakeVoxelGrid(*image, image->GetBufferedRegion());
  from.voxels = SamplerOf(LinearSampler<PixelType>(image->GetBufferPointer(), from.grid.size));
  std::vector<RealType> kept;
  if (m_HoldOut)
  {
    kept = this->WithoutHeldOutVoxels(from.grid);
    from.interpolated = this->MakeInterpolator(kept.data(), from.grid, arrays);
  }
  else
  {
    from.interpolated = this->MakeInterpolator(image->GetBufferPointer(), from.grid, arrays);
  }
  from.weights = this->MakeWeights(from.grid);

  DensityFitSettings settings;
  settings.degree = m_Degree;
  settings.tikhonov = m_Tikhonov;
  settings.voxelWeight = m_VoxelWeight;
  settings.overshootLimit = m_OvershootLimit;
  settings.surfaceMargin = m_SurfaceMargin;
  settings.interfaceMargin = m_InterfaceMargin;
  settings.maximumError = m_MaximumError;
  settings.holdOut = m_HoldOut;

  this->GetMultiThreader()->SetNumberOfWorkUnits(this->GetNumberOfWorkUnits());
  const DensityLoop loop = [this](std::size_t count, const std::function<void(std::size_t)> & body) {
    this->GetMultiThreader()->ParallelizeArray(0, count, body, this);
  };
  m_Report = FitDensity(arrays, from, settings, loop);
  if (m_Report.outside >= m_Report.samples)
  {
    itkExceptionMacro("The mesh lies wholly outside the input 'Image': are both of the same scan, and in LPS mm?");
  }
  if (!m_Report.finite)
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
  arrays.quantity = m_Quantity;
  this->Fit(arrays);
  m_NumberOfFreeCoefficients = 0;
  for (const int degree : arrays.degree)
  {
    m_NumberOfFreeCoefficients += BernsteinCount(degree);
  }
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
  os << indent << "Interpolator: " << m_Interpolator << '\n';
  os << indent << "VoxelWeight: " << m_VoxelWeight << '\n';
  os << indent << "OvershootLimit: " << m_OvershootLimit << '\n';
  os << indent << "SurfaceMargin: " << m_SurfaceMargin << '\n';
  os << indent << "InterfaceMargin: " << m_InterfaceMargin << '\n';
  os << indent << "MaximumError: " << m_MaximumError << '\n';
  os << indent << "HoldOut: " << (m_HoldOut ? "On" : "Off") << '\n';
  os << indent << "OutsideFraction: " << this->GetOutsideFraction() << '\n';
  os << indent << "NumberOfFreeCoefficients: " << m_NumberOfFreeCoefficients << '\n';
}
} // namespace bone

#endif
