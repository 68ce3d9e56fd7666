/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographSource_hxx
#define boneRadiographSource_hxx

#include "boneRadiographSource.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace bone
{
template <typename TOutputImage>
RadiographSource<TOutputImage>::RadiographSource()
{
  this->AddRequiredInputName("Geometry");
}

template <typename TOutputImage>
void
RadiographSource<TOutputImage>::VerifyPreconditions() ITKv5_CONST
{
  Superclass::VerifyPreconditions();
  for (unsigned int i = 0; i < this->GetNumberOfIndexedOutputs(); ++i)
  {
    if (this->GetGeometry(this->GetViewOfOutput(i)) == nullptr)
    {
      itkExceptionMacro("View " << this->GetViewOfOutput(i) << " has no geometry.");
    }
  }
  if (!(m_WaterAttenuation > 0) || !std::isfinite(m_WaterAttenuation))
  {
    itkExceptionMacro("WaterAttenuation is " << m_WaterAttenuation << " per mm; it must be positive.");
  }
  if (!(m_BoneSlope >= 0) || !std::isfinite(m_BoneSlope))
  {
    itkExceptionMacro("BoneSlope is " << m_BoneSlope << " per mm and HU; it must not be negative.");
  }
  const auto & table = m_AttenuationTable;
  const auto   usable = [](const AttenuationPoint & p) { return std::isfinite(p.hu) && p.attenuation >= 0; };
  bool         rising = std::all_of(table.begin(), table.end(), usable);
  for (std::size_t i = 1; i < table.size(); ++i)
  {
    rising = rising && table[i - 1].hu < table[i].hu;
  }
  if (m_HUToAttenuation == HUToAttenuation::Table && (table.empty() || !rising))
  {
    itkExceptionMacro("AttenuationTable ("
                      << table << ") must hold points of rising HU with attenuations that are not negative.");
  }
}

template <typename TOutputImage>
void
RadiographSource<TOutputImage>::GenerateOutputInformation()
{
  for (unsigned int i = 0; i < this->GetNumberOfIndexedOutputs(); ++i)
  {
    const auto &  view = this->GetGeometry(this->GetViewOfOutput(i))->GetView();
    const Vector3 axes[3] = { view.detectorU, view.detectorV, view.detectorU.cross(view.detectorV) };

    typename TOutputImage::RegionType    region;
    typename TOutputImage::PointType     origin;
    typename TOutputImage::SpacingType   spacing;
    typename TOutputImage::DirectionType direction;
    for (unsigned int k = 0; k < 3; ++k)
    {
      region.SetSize(k, k < 2 ? view.size[k] : 1);
      origin[k] = view.detectorOrigin[k];
      spacing[k] = k < 2 ? view.spacing[k] : 1.0;
      for (unsigned int row = 0; row < 3; ++row)
      {
        direction(row, k) = axes[k][row];
      }
    }
    TOutputImage * output = this->GetOutput(i);
    output->SetLargestPossibleRegion(region);
    output->SetOrigin(origin);
    output->SetSpacing(spacing);
    output->SetDirection(direction);
  }
}

template <typename TOutputImage>
void
RadiographSource<TOutputImage>::EnlargeOutputRequestedRegion(itk::DataObject * output)
{
  Superclass::EnlargeOutputRequestedRegion(output);
  output->SetRequestedRegionToLargestPossibleRegion();
}

template <typename TOutputImage>
void
RadiographSource<TOutputImage>::GenerateOutputRequestedRegion(itk::DataObject *)
{
  for (unsigned int i = 0; i < this->GetNumberOfIndexedOutputs(); ++i)
  {
    this->GetOutput(i)->SetRequestedRegionToLargestPossibleRegion();
  }
}

template <typename TOutputImage>
LoopRunner
RadiographSource<TOutputImage>::MakeLoops()
{
  const auto runner = [this](itk::ProcessObject * reporter) {
    return [this, reporter](std::size_t count, const std::function<void(std::size_t)> & body) {
      this->GetMultiThreader()->SetNumberOfWorkUnits(this->GetNumberOfWorkUnits());
      this->GetMultiThreader()->ParallelizeArray(
        0, count, [&](itk::SizeValueType i) { body(i); }, reporter);
    };
  };
  return { runner(nullptr), runner(this) };
}

template <typename TOutputImage>
void
RadiographSource<TOutputImage>::GenerateData()
{
  this->AllocateOutputs();
  std::vector<XRayGeometry::View> views;
  std::vector<std::vector<float>> integrals;
  std::vector<float *>            pointers;
  for (unsigned int i = 0; i < this->GetNumberOfIndexedOutputs(); ++i)
  {
    views.push_back(this->GetGeometry(this->GetViewOfOutput(i))->GetView());
    integrals.emplace_back(this->GetOutput(i)->GetBufferedRegion().GetNumberOfPixels());
    pointers.push_back(integrals.back().data());
  }
  this->ComputeIntegrals(views, pointers);
  for (unsigned int i = 0; i < this->GetNumberOfIndexedOutputs(); ++i)
  {
    std::transform(integrals[i].begin(), integrals[i].end(), this->GetOutput(i)->GetBufferPointer(), [](float value) {
      return static_cast<OutputPixelType>(value);
    });
  }
}

template <typename TOutputImage>
void
RadiographSource<TOutputImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  os << indent << "HUToAttenuation: " << m_HUToAttenuation << '\n';
  os << indent << "WaterAttenuation: " << m_WaterAttenuation << '\n';
  os << indent << "BoneSlope: " << m_BoneSlope << '\n';
  os << indent << "AttenuationTable: " << m_AttenuationTable << '\n';
}
} // namespace bone

#endif
