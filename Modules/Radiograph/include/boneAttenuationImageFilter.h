/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAttenuationImageFilter_h
#define boneAttenuationImageFilter_h

#include "boneAttenuation.h"

#include <itkImageRegionConstIterator.h>
#include <itkImageRegionIterator.h>
#include <itkInPlaceImageFilter.h>

namespace bone
{
/** \class AttenuationImageFilter
 * \brief Converts a CT in HU to an image of attenuation per mm.
 *
 * Fit a model to the result for radiographs whose conversion is not linear (Bilinear, Table).
 *
 * Parameters: \ref RadiographParameters, and AttenuationTable, which HUToAttenuation::Table needs. Without conversion
 * the input goes through. */
template <typename TInputImage, typename TOutputImage = itk::Image<float, 3>>
class AttenuationImageFilter : public itk::InPlaceImageFilter<TInputImage, TOutputImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(AttenuationImageFilter);
  using Self = AttenuationImageFilter;
  using Superclass = itk::InPlaceImageFilter<TInputImage, TOutputImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(AttenuationImageFilter, InPlaceImageFilter);

  BONE_FILTER_PARAMETERS(RadiographParameters, BONE_RADIOGRAPH_PARAMETERS)
  itkSetMacro(AttenuationTable, std::vector<AttenuationPoint>);
  itkGetConstReferenceMacro(AttenuationTable, std::vector<AttenuationPoint>);

protected:
  AttenuationImageFilter() { this->InPlaceOff(); }
  ~AttenuationImageFilter() override = default;

  void
  VerifyPreconditions() const override
  {
    Superclass::VerifyPreconditions();
    this->VerifyParameters();
    const std::string obstacle = AttenuationCurve{ m_Parameters, m_AttenuationTable }.FindObstacle();
    if (!obstacle.empty())
    {
      itkExceptionMacro(<< obstacle);
    }
  }
  void
  BeforeThreadedGenerateData() override
  {
    m_Curve = AttenuationCurve{ m_Parameters, m_AttenuationTable };
  }
  void
  DynamicThreadedGenerateData(const typename TOutputImage::RegionType & region) override
  {
    itk::ImageRegionConstIterator<TInputImage> from(this->GetInput(), region);
    for (itk::ImageRegionIterator<TOutputImage> to(this->GetOutput(), region); !to.IsAtEnd(); ++to, ++from)
    {
      to.Set(static_cast<typename TOutputImage::PixelType>(m_Curve.At(static_cast<double>(from.Get()))));
    }
  }

  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override
  {
    Superclass::PrintSelf(os, indent);
    PrintParameters(os, indent, m_Parameters);
    os << indent << "AttenuationTable: " << m_AttenuationTable << '\n';
  }

private:
  std::vector<AttenuationPoint> m_AttenuationTable;
  AttenuationCurve              m_Curve;
};
} // namespace bone

#endif
