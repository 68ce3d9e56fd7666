/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourTilingMeshSource_hxx
#define boneContourTilingMeshSource_hxx

#include "boneContourTilingMeshSource.h"

#include <itkLinearInterpolateImageFunction.h>
#include <itkMultiThreaderBase.h>

#include <limits>

namespace bone
{
template <typename TContourStack, typename TMesh>
ContourTilingMeshSource<TContourStack, TMesh>::ContourTilingMeshSource()
{
  this->SetNumberOfRequiredInputs(1);
  this->SetNumberOfRequiredOutputs(1);
  this->SetNthOutput(0, this->MakeOutput(0));
}

template <typename TContourStack, typename TMesh>
itk::DataObject::Pointer
ContourTilingMeshSource<TContourStack, TMesh>::MakeOutput(DataObjectPointerArraySizeType)
{
  return TMesh::New().GetPointer();
}

template <typename TContourStack, typename TMesh>
void
ContourTilingMeshSource<TContourStack, TMesh>::SetInput(const TContourStack * stack)
{
  this->SetNthInput(0, const_cast<TContourStack *>(stack));
}

template <typename TContourStack, typename TMesh>
const TContourStack *
ContourTilingMeshSource<TContourStack, TMesh>::GetInput() const
{
  return itkDynamicCastInDebugMode<const TContourStack *>(this->GetPrimaryInput());
}

template <typename TContourStack, typename TMesh>
void
ContourTilingMeshSource<TContourStack, TMesh>::SetDensityImage(const DensityImageType * image)
{
  this->Superclass::SetInput("DensityImage", const_cast<DensityImageType *>(image));
}

template <typename TContourStack, typename TMesh>
auto
ContourTilingMeshSource<TContourStack, TMesh>::GetDensityImage() const -> const DensityImageType *
{
  return dynamic_cast<const DensityImageType *>(this->Superclass::GetInput("DensityImage"));
}

template <typename TContourStack, typename TMesh>
void
ContourTilingMeshSource<TContourStack, TMesh>::SetMetricObject(std::shared_ptr<const TilingMetric> metric)
{
  if (metric != m_MetricObject)
  {
    m_MetricObject = std::move(metric);
    this->Modified();
  }
}

template <typename TContourStack, typename TMesh>
void
ContourTilingMeshSource<TContourStack, TMesh>::SetCorrespondence(
  std::shared_ptr<const ContourCorrespondence> correspondence)
{
  if (correspondence != m_Correspondence)
  {
    m_Correspondence = std::move(correspondence);
    this->Modified();
  }
}

template <typename TContourStack, typename TMesh>
TMesh *
ContourTilingMeshSource<TContourStack, TMesh>::GetOutput()
{
  return itkDynamicCastInDebugMode<TMesh *>(this->GetPrimaryOutput());
}

template <typename TContourStack, typename TMesh>
const TMesh *
ContourTilingMeshSource<TContourStack, TMesh>::GetOutput() const
{
  return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryOutput());
}

template <typename TContourStack, typename TMesh>
void
ContourTilingMeshSource<TContourStack, TMesh>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  if (!m_MetricObject)
  {
    // A sampler that is never called: only the name and the need for an image are looked at here.
    const DensitySampler sampler =
      this->GetDensityImage() != nullptr ? DensitySampler([](const Vector3 &) { return 0.0; }) : DensitySampler();
    try
    {
      MakeTilingMetric(m_Metric, sampler);
    }
    catch (const std::invalid_argument & error)
    {
      itkExceptionMacro(<< error.what());
    }
  }
}

template <typename TContourStack, typename TMesh>
void
ContourTilingMeshSource<TContourStack, TMesh>::GenerateInputRequestedRegion()
{
  Superclass::GenerateInputRequestedRegion();
  if (auto * image = const_cast<DensityImageType *>(this->GetDensityImage()))
  {
    image->SetRequestedRegionToLargestPossibleRegion();
  }
}

template <typename TContourStack, typename TMesh>
DensitySampler
ContourTilingMeshSource<TContourStack, TMesh>::MakeSampler() const
{
  const DensityImageType * image = this->GetDensityImage();
  if (image == nullptr)
  {
    return {};
  }
  using Interpolator = itk::LinearInterpolateImageFunction<DensityImageType, double>;
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

template <typename TContourStack, typename TMesh>
void
ContourTilingMeshSource<TContourStack, TMesh>::GenerateData()
{
  TilingParameters parameters;
  parameters.metric = m_MetricObject ? m_MetricObject : MakeTilingMetric(m_Metric, this->MakeSampler());
  parameters.correspondence = m_Correspondence;
  parameters.progress = [this](double share) {
    this->UpdateProgress(static_cast<float>(share));
    if (this->GetAbortGenerateData())
    {
      itk::ProcessAborted aborted(__FILE__, __LINE__);
      aborted.SetDescription("The tiling was aborted.");
      throw aborted;
    }
  };
  parameters.parallel = [this](std::size_t count, const std::function<void(std::size_t)> & body) {
    this->GetMultiThreader()->SetNumberOfWorkUnits(this->GetNumberOfWorkUnits());
    this->GetMultiThreader()->ParallelizeArray(
      0, count, [&body](itk::SizeValueType i) { body(i); }, nullptr);
  };
  this->GetInput()->Verify();
  MeshArrays mesh;
  try
  {
    mesh = TileContours(*this->GetInput(), parameters, m_Report);
  }
  catch (const std::runtime_error & error)
  {
    itkExceptionMacro(<< error.what());
  }
  this->GetOutput()->SetArrays(std::move(mesh));
}

template <typename TContourStack, typename TMesh>
void
ContourTilingMeshSource<TContourStack, TMesh>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "Metric: " << (m_MetricObject ? "object" : m_Metric) << '\n';
  os << indent << "Correspondence: " << (m_Correspondence ? "given" : "found") << '\n';
  os << indent << "Slabs: " << m_Report.slabs << '\n';
}
} // namespace bone

#endif
