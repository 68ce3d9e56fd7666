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
 * The output has the input's contours, in order, as the polygons nearest to them whose corners stand where the splines
 * say; medial axes are left out, since they
 * belong to the contours as they were. How: \ref SampleSlice. Contours stay simple, nested and
 * MinimumLayerDistance apart: an inner contour that is nearer, as given or where it is coarsely sampled, is moved in; a
 * warning names the slices where that cannot be.
 *
 * In place of the spacings themselves, a total may be asked for: with TargetNumberOfSamples or TargetNumberOfTetrahedra
 * all spacings, limits too, are multiplied by one factor, found by the secant rule, that gives the number to within 2 %
 * (or comes as near as a few trials and eight samples a contour allow, which a warning says). Tetrahedra are those that
 * tiling the samples is expected to give: \ref EstimateTetrahedra. */
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
  /** Factor of the tolerance for the contours of inner layers. Default 2.5. */
  itkSetMacro(InnerToleranceFactor, double);
  itkGetConstMacro(InnerToleranceFactor, double);
  /** Least (default 0.8) and largest (default 4) distance between samples, mm. */
  itkSetMacro(MinimumSpacing, double);
  itkGetConstMacro(MinimumSpacing, double);
  itkSetMacro(MaximumSpacing, double);
  itkGetConstMacro(MaximumSpacing, double);
  /** Least distance between a contour and the next inside it, mm. Default 0.8. */
  itkSetMacro(MinimumLayerDistance, double);
  itkGetConstMacro(MinimumLayerDistance, double);
  /** Samples lie at most this many times the local distance to the next contour apart (but MinimumSpacing). Default 6.
   */
  itkSetMacro(ThinLayerRatio, double);
  itkGetConstMacro(ThinLayerRatio, double);

  /** Number of samples in all closed contours, about; 0 (default): as the spacings give. */
  itkSetMacro(TargetNumberOfSamples, std::size_t);
  itkGetConstMacro(TargetNumberOfSamples, std::size_t);
  /** Number of tetrahedra of a tiling, about; 0 (default): as the spacings give. Not together with the other target. */
  itkSetMacro(TargetNumberOfTetrahedra, std::size_t);
  itkGetConstMacro(TargetNumberOfTetrahedra, std::size_t);

  /** After an update: the factor of all spacings; 1 without a target. */
  itkGetConstMacro(SpacingScale, double);
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
  /** Makes the output with the spacing scale as it is. */
  void
  SampleAll();
  /** Finds the scale for the target and makes the output with it. */
  void
  SampleForTarget();

  double                      m_Tolerance{ 0.2 };
  double                      m_MinimumSpacing{ 0.8 };
  double                      m_MaximumSpacing{ 4.0 };
  double                      m_MinimumLayerDistance{ 0.8 };
  double                      m_InnerToleranceFactor{ 2.5 };
  double                      m_ThinLayerRatio{ 6.0 };
  std::size_t                 m_TargetNumberOfSamples{ 0 };
  std::size_t                 m_TargetNumberOfTetrahedra{ 0 };
  double                      m_SpacingScale{ 1.0 };
  std::vector<SamplingReport> m_SliceReports;
  SamplingReport              m_Report;
  std::vector<std::string>    m_Warnings;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneContourResampleFilter.hxx"
#endif

#endif
