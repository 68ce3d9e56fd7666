/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneIntensityImageFilter_h
#define boneIntensityImageFilter_h

#include "boneDetectorParameters.h"

#include <itkImageRegionConstIterator.h>
#include <itkImageRegionIterator.h>
#include <itkUnaryFunctorImageFilter.h>

#include <cmath>

namespace bone
{
/** The functor of IntensityImageFilter. */
template <typename TInput, typename TOutput>
struct IntensityFunctor
{
  double incident{ IntensityParameters().incidentIntensity };
  TOutput
  operator()(const TInput & integral) const
  {
    return static_cast<TOutput>(incident * std::exp(-static_cast<double>(integral)));
  }
  bool
  operator==(const IntensityFunctor & other) const
  {
    return incident == other.incident;
  }
  bool
  operator!=(const IntensityFunctor & other) const
  {
    return !(*this == other);
  }
};

/** \class IntensityImageFilter
 * \brief Intensity at the detector by Beer and Lambert's law, I = I0 exp(-integral of mu), for one energy and without
 * scatter.
 *
 * Input: a radiograph of line integrals of attenuation (HUToAttenuation not None). Parameter: IncidentIntensity I0,
 * for example the photons per pixel that NoiseImageFilter then draws from. */
template <typename TInputImage, typename TOutputImage = TInputImage>
class IntensityImageFilter
  : public itk::UnaryFunctorImageFilter<
      TInputImage,
      TOutputImage,
      IntensityFunctor<typename TInputImage::PixelType, typename TOutputImage::PixelType>>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(IntensityImageFilter);
  using Self = IntensityImageFilter;
  using FunctorType = IntensityFunctor<typename TInputImage::PixelType, typename TOutputImage::PixelType>;
  using Superclass = itk::UnaryFunctorImageFilter<TInputImage, TOutputImage, FunctorType>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(IntensityImageFilter, UnaryFunctorImageFilter);

  BONE_PLAIN_FILTER_PARAMETERS(IntensityParameters, BONE_INTENSITY_PARAMETERS)

protected:
  IntensityImageFilter() = default;
  ~IntensityImageFilter() override = default;

  void
  BeforeThreadedGenerateData() override
  {
    this->GetFunctor().incident = m_Parameters.incidentIntensity;
  }
  /** Without the superclass's report of progress by pixels, which the threader reports too, by pieces. */
  void
  DynamicThreadedGenerateData(const typename TOutputImage::RegionType & region) override
  {
    itk::ImageRegionConstIterator<TInputImage> from(this->GetInput(), region);
    for (itk::ImageRegionIterator<TOutputImage> to(this->GetOutput(), region); !to.IsAtEnd(); ++to, ++from)
    {
      to.Set(this->GetFunctor()(from.Get()));
    }
  }
};
} // namespace bone

#endif
