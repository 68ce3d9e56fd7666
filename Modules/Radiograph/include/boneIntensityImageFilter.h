/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneIntensityImageFilter_h
#define boneIntensityImageFilter_h

#include "boneDetectorParameters.h"

#include <itkImageRegionConstIterator.h>
#include <itkImageRegionIterator.h>
#include <itkInPlaceImageFilter.h>

#include <cmath>

namespace bone
{
/** \class IntensityImageFilter
 * \brief Intensity at the detector by Beer and Lambert's law, I = I0 exp(-integral of mu), for one energy and without
 * scatter.
 *
 * Input: a radiograph of line integrals of attenuation (HUToAttenuation not None). Parameter: IncidentIntensity I0,
 * for example the photons per pixel that NoiseImageFilter then draws from. */
template <typename TInputImage, typename TOutputImage = TInputImage>
class IntensityImageFilter : public itk::InPlaceImageFilter<TInputImage, TOutputImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(IntensityImageFilter);
  using Self = IntensityImageFilter;
  using Superclass = itk::InPlaceImageFilter<TInputImage, TOutputImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(IntensityImageFilter, InPlaceImageFilter);

  BONE_PLAIN_FILTER_PARAMETERS(IntensityParameters, BONE_INTENSITY_PARAMETERS)

protected:
  IntensityImageFilter() { this->InPlaceOff(); }
  ~IntensityImageFilter() override = default;

  void
  DynamicThreadedGenerateData(const typename TOutputImage::RegionType & region) override
  {
    const double                               incident = m_Parameters.incidentIntensity;
    itk::ImageRegionConstIterator<TInputImage> from(this->GetInput(), region);
    for (itk::ImageRegionIterator<TOutputImage> to(this->GetOutput(), region); !to.IsAtEnd(); ++to, ++from)
    {
      to.Set(static_cast<typename TOutputImage::PixelType>(incident * std::exp(-static_cast<double>(from.Get()))));
    }
  }
};
} // namespace bone

#endif
