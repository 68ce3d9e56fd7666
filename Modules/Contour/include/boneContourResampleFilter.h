/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourResampleFilter_h
#define boneContourResampleFilter_h

#include "boneContourStackFilter.h"
#include "boneContourStackParameters.h"

#include <string>
#include <vector>

namespace bone
{
/** How a slice's contours came out. */
struct SamplingReport
{
  int    samples{ 0 };        ///< on closed contours
  int    moved{ 0 };          ///< samples moved off their spline to keep the minimum distance
  int    near{ 0 };           ///< pairs of layers left nearer than the minimum distance, as they were given
  int    refined{ 0 };        ///< contours sampled more finely because they would have crossed or come too near
  int    unfitted{ 0 };       ///< contours kept as given: no spline could be had that stays clear of the others
  double largestError{ 0.0 }; ///< distance from a given point to its spline, mm
};

/** \class ContourResampleFilter
 * \brief Fits closed cubic B-splines to contours and samples them by curvature (paper 2.1).
 *
 * The output has the input's contours, in order, as the polygons nearest to them in the mean square whose corners lie
 * where the splines are sampled: closer where they curve, and where the next contour is near. Medial axes are left out,
 * since they belong to the contours as they were. Contours stay simple, nested and MinimumLayerDistance apart: an inner
 * contour that is nearer, as given or where it is coarsely sampled, is moved in; a warning names the slices where that
 * cannot be.
 *
 * In place of the spacings themselves, a total may be asked for: with TargetNumberOfSamples or TargetNumberOfTetrahedra
 * all spacings, limits too, are multiplied by one factor, found by the secant rule, that gives the number to within 2 %
 * (or comes as near as a few trials and eight samples a contour allow, which a warning says). Tetrahedra are those that
 * tiling the samples is expected to give, good to a quarter. Parameters: \ref ContourResampleParameters. */
class ContourResampleFilter : public ContourStackFilter
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourResampleFilter);
  using Self = ContourResampleFilter;
  using Superclass = ContourStackFilter;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(ContourResampleFilter, ContourStackFilter);

  BONE_FILTER_PARAMETERS(ContourResampleParameters, BONE_CONTOUR_RESAMPLE_PARAMETERS)

  /** After an update: the factor of all spacings; 1 without a target. */
  itkGetConstMacro(SpacingScale, double);
  /** After an update: what happened, over all slices. */
  itkGetConstReferenceMacro(Report, SamplingReport);
  /** What a person should know, in words. */
  itkGetConstReferenceMacro(Warnings, std::vector<std::string>);

protected:
  ContourResampleFilter() = default;
  ~ContourResampleFilter() override = default;

  void
  VerifyPreconditions() const override;
  void
  GenerateData() override;
  ContourSlice
  MakeSlice(const ContourStack & input, std::size_t k) override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  /** Makes the output with the spacing scale as it is. */
  void
  SampleAll(const Execution & execution);
  /** Finds the scale for the target and makes the output with it. */
  void
  SampleForTarget(const Execution & execution);

  double                      m_SpacingScale{ 1.0 };
  std::vector<SamplingReport> m_SliceReports;
  SamplingReport              m_Report;
  std::vector<std::string>    m_Warnings;
};
} // namespace bone

#endif
