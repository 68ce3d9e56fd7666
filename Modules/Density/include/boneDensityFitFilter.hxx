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
#include "boneWorseyFarinSplit.h"

#include <algorithm>
#include <cmath>
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
  this->AddRequiredInputName("Image");
  this->AddOptionalInputName("Weights");
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  this->VerifyParameters();
  const std::string conflict = FindConflict(m_Parameters);
  if (!conflict.empty())
  {
    itkExceptionMacro("" << conflict << '.');
  }
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::VerifyInputs() const
{
  if (this->GetImage()->GetBufferedRegion().GetNumberOfPixels() == 0)
  {
    itkExceptionMacro("The input 'Image' has no voxels.");
  }
}

template <typename TImage, typename TMesh>
auto
DensityFitFilter<TImage, TMesh>::WithoutHeldOutVoxels(const VoxelGrid & grid, const Execution & execution) const
  -> std::vector<RealType>
{
  const auto *          buffer = this->GetImage()->GetBufferPointer();
  std::vector<RealType> values(buffer, buffer + grid.NumberOfVoxels());
  execution.Silent().For(grid.size[2], [&](std::size_t slice) {
    const auto k = static_cast<int>(slice);
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
  });
  return values;
}

template <typename TImage, typename TMesh>
template <typename TPixel>
ImageSampler
DensityFitFilter<TImage, TMesh>::MakeInterpolator(const TPixel *     buffer,
                                                  const VoxelGrid &  grid,
                                                  const MeshArrays & arrays,
                                                  const Execution &  execution) const
{
  if (m_Parameters.interpolator == DensityInterpolator::Linear)
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
  std::vector<float> block(static_cast<std::size_t>(size[0]) * size[1] * size[2]);
  execution.Silent().For(size[2], [&](std::size_t k) {
    for (int j = 0; j < size[1]; ++j)
    {
      const TPixel * row = buffer + ((first[2] + k) * grid.size[1] + first[1] + j) * grid.size[0] + first[0];
      std::transform(
        row, row + size[0], &block[(k * size[1] + j) * size[0]], [](TPixel x) { return static_cast<float>(x); });
    }
  });
  return SamplerOf(
    [sampler = std::make_shared<CubicSampler>(std::move(block), size, execution),
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
DensityFitFilter<TImage, TMesh>::Fit(MeshArrays & arrays, const Execution & execution)
{
  using PixelType = typename TImage::PixelType;
  const TImage *  image = this->GetImage();
  DensityFitImage from;
  from.grid = MakeVoxelGrid(*image, image->GetBufferedRegion());
  from.voxels = SamplerOf(LinearSampler<PixelType>(image->GetBufferPointer(), from.grid.size));
  std::vector<RealType> kept;
  if (m_Parameters.holdOut)
  {
    kept = this->WithoutHeldOutVoxels(from.grid, execution);
    from.interpolated = this->MakeInterpolator(kept.data(), from.grid, arrays, execution.Part(0.0, 0.1));
  }
  else
  {
    from.interpolated = this->MakeInterpolator(image->GetBufferPointer(), from.grid, arrays, execution.Part(0.0, 0.1));
  }
  from.weights = this->MakeWeights(from.grid);

  m_Report = FitDensity(arrays, from, m_Parameters, execution.Part(0.1, 1.0));
  if (m_Report.outside >= m_Report.samples)
  {
    itkExceptionMacro("The mesh lies wholly outside the input 'Image': are both of the same scan, and in LPS mm?");
  }
  if (!m_Report.finite)
  {
    itkExceptionMacro("The input 'Image' has voxels in the mesh that are not finite: repair it first.");
  }
  m_Contrast = MeasureSurfaceContrast(arrays, from.grid, from.voxels);
}

template <typename TImage, typename TMesh>
std::vector<std::string>
DensityFitFilter<TImage, TMesh>::GetDoubts() const
{
  std::vector<std::string> doubts;
  if (const std::string line = m_Contrast.FindMismatch("mesh"); !line.empty())
  {
    doubts.push_back(line);
  }
  if (this->GetOutsideFraction() > LargestOutsideFraction)
  {
    doubts.push_back(
      std::to_string(std::lround(100.0 * this->GetOutsideFraction())) +
      " % of the mesh lie outside the image, and have the values of its border: are both of the same scan?");
  }
  return doubts;
}

template <typename TImage, typename TMesh>
std::size_t
DensityFitFilter<TImage, TMesh>::FitSpline(MeshArrays & arrays, const Execution & execution)
{
  const Execution fit = execution.Part(0.0, 0.5), join = execution.Part(0.5, 1.0);
  try
  {
    if (!m_Parameters.continuousGradient)
    {
      this->Fit(arrays, fit);
      return MakeDensityContinuous(arrays, join).freeCoefficients;
    }
    const MeshArrays mesh = std::move(arrays);
    arrays = SplitWorseyFarin(mesh);
    this->Fit(arrays, fit);
    return MakeGradientContinuous(mesh, arrays, join).freeCoefficients;
  }
  catch (const std::logic_error & error)
  {
    itkExceptionMacro("" << error.what());
  }
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::GenerateData()
{
  MeshArrays      arrays = this->CopyInput();
  const Execution execution(this);
  this->VerifyInputs();
  arrays.quantity = m_Parameters.quantity;
  if (m_Parameters.continuous || m_Parameters.continuousGradient)
  {
    m_NumberOfFreeCoefficients = this->FitSpline(arrays, execution);
  }
  else
  {
    this->Fit(arrays, execution);
    m_NumberOfFreeCoefficients = 0;
    for (const int degree : arrays.degree)
    {
      m_NumberOfFreeCoefficients += BernsteinCount(degree);
    }
  }
  this->SetResult(std::move(arrays));
}

template <typename TImage, typename TMesh>
void
DensityFitFilter<TImage, TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "OutsideFraction: " << this->GetOutsideFraction() << '\n';
  os << indent << "NumberOfFreeCoefficients: " << m_NumberOfFreeCoefficients << '\n';
}
} // namespace bone

#endif
