/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourResampleFilter_h
#define boneContourResampleFilter_h

#include "boneContourSampling.h"
#include "boneContourStackFilter.h"

#include <string>

namespace bone
{
/** \class ContourResampleFilter
 * \brief Fits closed cubic B-splines to contours and samples them by curvature (paper 2.1).
 *
 * The output has the input's contours, in order, with points on the splines; medial axes are left out, since they
 * belong to the contours as they were. How: \ref SampleSlice. Contours stay simple, nested and (as far as the input
 * keeps it) half of MinimumLayerDistance apart. */
template <typename TContourStack = ContourStack>
class ContourResampleFilter : public ContourStackFilter<TContourStack>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourResampleFilter);
  using Self = ContourResampleFilter;
  using Superclass = ContourStackFilter<TContourStack>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(ContourResampleFilter, ContourStackFilter);

  /** Distance of the given points to the spline, and of chords to it, at most, mm. Default 0.2. */
  itkSetMacro(Tolerance, double);
  itkGetConstMacro(Tolerance, double);
  /** Least (default 0.8) and largest (default 4) distance between samples, mm. */
  itkSetMacro(MinimumSpacing, double);
  itkGetConstMacro(MinimumSpacing, double);
  itkSetMacro(MaximumSpacing, double);
  itkGetConstMacro(MaximumSpacing, double);
  /** Distance between nested contours that the input keeps, mm. Default 0.8. */
  itkSetMacro(MinimumLayerDistance, double);
  itkGetConstMacro(MinimumLayerDistance, double);
  /** Samples lie at most this many times the local distance to the next contour apart (but MinimumSpacing). Default 2.
   */
  itkSetMacro(ThinLayerRatio, double);
  itkGetConstMacro(ThinLayerRatio, double);

  /** After an update: what happened, over all slices. */
  const SamplingReport &
  GetReport() const
  {
    return m_Report;
  }
  /** What a person should know, in words. */
  const std::vector<std::string> &
  GetWarnings() const
  {
    return m_Warnings;
  }

protected:
  ContourResampleFilter() = default;
  ~ContourResampleFilter() override = default;

  void
  VerifyPreconditions() ITKv5_CONST override;
  void
  GenerateData() override;
  ContourSlice
  MakeSlice(const TContourStack & input, std::size_t k) override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  double                      m_Tolerance{ 0.2 };
  double                      m_MinimumSpacing{ 0.8 };
  double                      m_MaximumSpacing{ 4.0 };
  double                      m_MinimumLayerDistance{ 0.8 };
  double                      m_ThinLayerRatio{ 2.0 };
  std::vector<SamplingReport> m_SliceReports;
  SamplingReport              m_Report;
  std::vector<std::string>    m_Warnings;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneContourResampleFilter.hxx"
#endif

#endif
