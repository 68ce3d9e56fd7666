/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographPreprocessFilter_h
#define boneRadiographPreprocessFilter_h

#include "boneRadiographPreprocess.h"

#include <itkImage.h>
#include <itkImageToImageFilter.h>

namespace bone
{
/** \class RadiographPreprocessFilter
 * \brief Turns an X-ray image into line integrals of attenuation, with a weight for each pixel.
 *
 * Inputs: a radiograph, columns x rows x 1, whose pixels are of the kind Values; "Mask", optional: 0 where it is not to
 * be used, of the same columns and rows (its place in space is not looked at). Outputs, on the input's grid:
 * 0, the line integrals; 1 (GetWeights), weights from 0 to 1.
 *
 * - Line integrals (`integral`) pass through.
 * - Intensities (`intensity`) I become -log(P / I0), Beer and Lambert's law. I0 is OpenBeam, or estimated: the median
 * of the brightest pixels of the exposed field, those within 10 % of its 99.5 % quantile (means of 5 x 5 pixels). The
 *   report says which, and how much air there is.
 * - Display values (`display`) become pseudo integrals, from 0 to 1 between the quantiles of 0.5 and 99.5 % of the
 *   exposed field (DisplayCurve linear), or the negative logarithm of what remains (log). They rise with attenuation
 * and mean no more: IsMonotoneOnly() says so, and whoever needs density refuses them.
 *
 * With ScatterToPrimary P is the primary of \ref Scatter, whose photons with their scatter are I; otherwise P = I.
 * Scatter needs photons, so it is refused for display values; line integrals are turned into photons of I0 = 1 and
 * back.
 *
 * Weight 0 have pixels outside of the mask, the crop or the exposed field, pixels that are NaN or infinite, and, but
 * for line integrals: dead pixels, intensities that are not above 0, and display values at the dense end of the range
 * where 0.5 % of the field or more have that same value. Pixels at or above I0, or at the other end of the display's
 * range, have AirWeight. Dead pixels (isolated, alone or two) and those that are not finite get the median of 5 x 5
 * pixels. The exposed field is looked for where it has straight borders (\ref CollimatorEdge, in pixels from the
 * first one of the image).
 *
 * The whole image is always made. The result does not depend on the number of threads.
 *
 * Throws itk::ExceptionObject, in one line, where a parameter is out of its range, the input is thicker than a pixel,
 * the mask is of another size, no pixel is finite or has a weight, or all that have one are the same. */
template <typename TInputImage = itk::Image<float, 3>,
          typename TOutputImage = itk::Image<float, 3>,
          typename TMaskImage = itk::Image<short, 3>>
class RadiographPreprocessFilter : public itk::ImageToImageFilter<TInputImage, TOutputImage>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(RadiographPreprocessFilter);
  using Self = RadiographPreprocessFilter;
  using Superclass = itk::ImageToImageFilter<TInputImage, TOutputImage>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(RadiographPreprocessFilter, ImageToImageFilter);

  using WeightImageType = itk::Image<float, 3>;
  using MaskImageType = TMaskImage;
  static_assert(TInputImage::ImageDimension == 3 && TOutputImage::ImageDimension == 3 &&
                  TMaskImage::ImageDimension == 3,
                "A radiograph lies in space: it needs three-dimensional images.");

  itkSetInputMacro(Mask, TMaskImage);
  itkGetInputMacro(Mask, TMaskImage);

  BONE_FILTER_PARAMETERS(RadiographPreprocessParameters, BONE_RADIOGRAPH_PREPROCESS_PARAMETERS)

  WeightImageType *
  GetWeights();

  /** Whether the values rise with attenuation and mean no more. */
  bool
  IsMonotoneOnly() const
  {
    return m_Parameters.values == RadiographValues::Display;
  }

  /** Of the last run. */
  itkGetConstReferenceMacro(Report, RadiographPreprocessReport);

  using itk::ImageToImageFilter<TInputImage, TOutputImage>::MakeOutput;
  itk::ProcessObject::DataObjectPointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override;

protected:
  RadiographPreprocessFilter();
  ~RadiographPreprocessFilter() override = default;

  void
  VerifyPreconditions() const override;
  void
  VerifyInputInformation() const override;
  void
  GenerateInputRequestedRegion() override;
  void
  EnlargeOutputRequestedRegion(itk::DataObject * output) override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  RadiographPreprocessReport m_Report;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneRadiographPreprocessFilter.hxx"
#endif

#endif
