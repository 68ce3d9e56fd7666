/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographSource_hxx
#define boneRadiographSource_hxx

#include "boneRadiographSource.h"

#include <algorithm>
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
RadiographSource<TOutputImage>::VerifyPreconditions() const
{
  Superclass::VerifyPreconditions();
  for (unsigned int i = 0; i < this->GetNumberOfIndexedOutputs(); ++i)
  {
    if (this->GetGeometry(this->GetViewOfOutput(i)) == nullptr)
    {
      itkExceptionMacro("View " << this->GetViewOfOutput(i) << " has no geometry.");
    }
  }
  this->VerifyParameters();
  const std::string obstacle = this->GetCurve().FindObstacle();
  if (!obstacle.empty())
  {
    itkExceptionMacro(<< obstacle);
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
  this->ComputeIntegrals(views, Execution(this), pointers);
  for (unsigned int i = 0; i < this->GetNumberOfIndexedOutputs(); ++i)
  {
    std::transform(integrals[i].begin(), integrals[i].end(), this->GetOutput(i)->GetBufferPointer(), [](float value) {
      return static_cast<OutputPixelType>(value);
    });
  }
  this->UpdateProgress(1.0f);
}

template <typename TOutputImage>
void
RadiographSource<TOutputImage>::PrintSelf(std::ostream & os, itk::Indent indent) const
{
  Superclass::PrintSelf(os, indent);
  PrintParameters(os, indent, m_Parameters);
  os << indent << "AttenuationTable: " << m_AttenuationTable << '\n';
}
} // namespace bone

#endif
