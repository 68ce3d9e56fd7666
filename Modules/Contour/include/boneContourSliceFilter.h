/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourSliceFilter_h
#define boneContourSliceFilter_h

#include "boneContourStackFilter.h"
#include "boneSliceSelection.h"

namespace bone
{
/** \class ContourSliceFilter
 * \brief Keeps the slices of a stack from which the others are best told: more where sections change, fewer where they
 * do not.
 *
 * About height / MeanSpacing slices are kept; see \ref SelectSlices for how they are chosen. With MeanSpacing 0
 * (default), or one below the stack's own, all are kept. Slices before the first and after the last contour are left
 * out. Contours are copied as they are. Errors (itk::ExceptionObject): as \ref ContourStackFilter; a parameter out of
 * range. The result does not depend on the number of threads. */
template <typename TContourStack = ContourStack>
class ContourSliceFilter : public ContourStackFilter<TContourStack>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourSliceFilter);
  using Self = ContourSliceFilter;
  using Superclass = ContourStackFilter<TContourStack>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(ContourSliceFilter, ContourStackFilter);

  /** Mean distance of the slices kept, mm. Default 0: all. */
  itkSetMacro(MeanSpacing, double);
  itkGetConstMacro(MeanSpacing, double);
  /** Largest distance of neighbouring slices kept, in mean distances. Default 1.75. */
  itkSetMacro(MaximumGap, double);
  itkGetConstMacro(MaximumGap, double);

  /** After an update: volume misplaced between the slices kept, mm^3. */
  itkGetConstMacro(MisplacedVolume, double);

protected:
  ContourSliceFilter() = default;
  ~ContourSliceFilter() override = default;

  void
  VerifyPreconditions() ITKv5_CONST override;
  std::vector<std::size_t>
  ChooseSlices(const TContourStack & input) override;
  ContourSlice
  MakeSlice(const TContourStack & input, std::size_t k) override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  double m_MeanSpacing{ 0.0 };
  double m_MaximumGap{ 1.75 };
  double m_MisplacedVolume{ 0.0 };
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneContourSliceFilter.hxx"
#endif

#endif
