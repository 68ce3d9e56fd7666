/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMedialAxisFilter_h
#define boneMedialAxisFilter_h

#include "boneContourStackFilter.h"
#include "boneMedialAxis.h"

namespace bone
{
/** \class MedialAxisFilter
 * \brief Adds the pruned medial axis of each innermost contour as the innermost layer (paper 2.1).
 *
 * The output has the input's closed contours and, for each of them that is no hole and holds nothing but holes, the
 * axis of the bone in it: polylines with `axis` set, the contour's layer + 1, its region, and each point's `clearance`.
 * Branches share their end points and form a tree, with a cycle around each hole; a round contour has a single point.
 * Axes of the input are replaced. How: \ref ComputeMedialAxis. */
template <typename TContourStack = ContourStack>
class MedialAxisFilter : public ContourStackFilter<TContourStack>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(MedialAxisFilter);
  using Self = MedialAxisFilter;
  using Superclass = ContourStackFilter<TContourStack>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(MedialAxisFilter, ContourStackFilter);

  /** Distance between samples of the axis, mm; 0 (default): the mean distance of the contour's points. */
  itkSetMacro(Spacing, double);
  itkGetConstMacro(Spacing, double);
  /** See \ref MedialAxisParameters. Default 0.8. */
  itkSetMacro(Significance, double);
  itkGetConstMacro(Significance, double);
  /** See \ref MedialAxisParameters. Default 1. */
  itkSetMacro(Roundness, double);
  itkGetConstMacro(Roundness, double);

protected:
  MedialAxisFilter() = default;
  ~MedialAxisFilter() override = default;

  void
  VerifyPreconditions() ITKv5_CONST override;
  ContourSlice
  MakeSlice(const TContourStack & input, std::size_t k) override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  double m_Spacing{ 0.0 };
  double m_Significance{ 0.8 };
  double m_Roundness{ 1.0 };
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneMedialAxisFilter.hxx"
#endif

#endif
