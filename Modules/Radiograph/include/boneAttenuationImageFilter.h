/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAttenuationImageFilter_h
#define boneAttenuationImageFilter_h

#include "boneAttenuation.h"

#include <itkUnaryFunctorImageFilter.h>

namespace bone
{
/** The functor of AttenuationImageFilter. */
template <typename TInput, typename TOutput>
struct AttenuationFunctor
{
  AttenuationCurve curve;
  TOutput
  operator()(const TInput & value) const
  {
    return static_cast<TOutput>(curve.At(static_cast<double>(value)));
  }
  bool
  operator==(const AttenuationFunctor & other) const
  {
    return curve.conversion == other.curve.conversion && curve.water == other.curve.water &&
           curve.boneSlope == other.curve.boneSlope && curve.table == other.curve.table;
  }
  bool
  operator!=(const AttenuationFunctor & other) const
  {
    return !(*this == other);
  }
};

/** \class AttenuationImageFilter
 * \brief A CT in HU as an image of attenuation per mm: fit a model to that for radiographs with a curve that is no line
 * (Bilinear, Table).
 *
 * Parameter: Curve (default: none; the input goes through). Its table must hold points of rising HU. */
template <typename TInputImage, typename TOutputImage = itk::Image<float, 3>>
class AttenuationImageFilter
  : public itk::UnaryFunctorImageFilter<
      TInputImage,
      TOutputImage,
      AttenuationFunctor<typename TInputImage::PixelType, typename TOutputImage::PixelType>>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(AttenuationImageFilter);
  using Self = AttenuationImageFilter;
  using FunctorType = AttenuationFunctor<typename TInputImage::PixelType, typename TOutputImage::PixelType>;
  using Superclass = itk::UnaryFunctorImageFilter<TInputImage, TOutputImage, FunctorType>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(AttenuationImageFilter, UnaryFunctorImageFilter);

  void
  SetCurve(const AttenuationCurve & curve)
  {
    this->SetFunctor(FunctorType{ curve });
  }
  const AttenuationCurve &
  GetCurve() const
  {
    return this->GetFunctor().curve;
  }

protected:
  AttenuationImageFilter() = default;
  ~AttenuationImageFilter() override = default;

  void
  VerifyPreconditions() ITKv5_CONST override
  {
    Superclass::VerifyPreconditions();
    if (GetCurve().conversion == HUToAttenuation::Table && GetCurve().table.empty())
    {
      itkExceptionMacro("The curve's table is empty.");
    }
  }
};
} // namespace bone

#endif
