/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneNoiseImageFilter_h
#define boneNoiseImageFilter_h

#include "boneDetectorParameters.h"

#include <itkImageRegionConstIterator.h>
#include <itkImageRegionIterator.h>
#include <itkImageToImageFilter.h>

#include <cmath>
#include <cstdint>
#include <random>

namespace bone
{
/** \class NoiseImageFilter
 * \brief Quantum and electronic noise of an image of intensities.
 *
 * Each pixel of expected intensity I becomes a Poisson number of mean I * PhotonsPerUnit, over PhotonsPerUnit, plus a
 * normal number of standard deviation ElectronicNoise. Reproducible: each pixel draws from its own sequence, by Seed
 * and its place in the image, so that threads and regions do not matter.
 *
 * Parameters: \ref NoiseParameters. Refused: intensities that are negative or not finite. */
template <typename TImage>
class NoiseImageFilter : public itk::ImageToImageFilter<TImage, TImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(NoiseImageFilter);
  using Self = NoiseImageFilter;
  using Superclass = itk::ImageToImageFilter<TImage, TImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(NoiseImageFilter, ImageToImageFilter);

  using RegionType = typename TImage::RegionType;
  using PixelType = typename TImage::PixelType;

  BONE_PLAIN_FILTER_PARAMETERS(NoiseParameters, BONE_NOISE_PARAMETERS)

protected:
  NoiseImageFilter() { this->DynamicMultiThreadingOn(); }
  ~NoiseImageFilter() override = default;

  void
  DynamicThreadedGenerateData(const RegionType & region) override
  {
    const TImage *                        input = this->GetInput();
    const RegionType &                    whole = input->GetLargestPossibleRegion();
    itk::ImageRegionConstIterator<TImage> from(input, region);
    for (itk::ImageRegionIterator<TImage> to(this->GetOutput(), region); !to.IsAtEnd(); ++to, ++from)
    {
      std::uint64_t place = 0;
      for (unsigned int k = TImage::ImageDimension; k-- > 0;)
      {
        place = place * whole.GetSize(k) + static_cast<std::uint64_t>(from.GetIndex()[k] - whole.GetIndex(k));
      }
      to.Set(static_cast<PixelType>(Draw(static_cast<double>(from.Get()), place)));
    }
  }

private:
  double
  Draw(double intensity, std::uint64_t place) const
  {
    if (!(intensity >= 0) || !std::isfinite(intensity))
    {
      itkExceptionMacro("An intensity is " << intensity << "; it must be finite and not negative.");
    }
    std::seed_seq    seeds{ static_cast<std::uint32_t>(m_Parameters.seed),
                         static_cast<std::uint32_t>(m_Parameters.seed >> 32),
                         static_cast<std::uint32_t>(place),
                         static_cast<std::uint32_t>(place >> 32) };
    std::minstd_rand random(seeds);
    double           value = intensity;
    if (m_Parameters.photonsPerUnit > 0 && intensity > 0)
    {
      std::poisson_distribution<std::int64_t> photons(intensity * m_Parameters.photonsPerUnit);
      value = static_cast<double>(photons(random)) / m_Parameters.photonsPerUnit;
    }
    std::normal_distribution<double> electronic(0.0, 1.0);
    return m_Parameters.electronicNoise > 0 ? value + m_Parameters.electronicNoise * electronic(random) : value;
  }
};
} // namespace bone

#endif
