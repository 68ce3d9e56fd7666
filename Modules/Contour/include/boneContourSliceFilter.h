/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourSliceFilter_h
#define boneContourSliceFilter_h

#include "boneContourStackFilter.h"
#include "boneContourStackParameters.h"

namespace bone
{
/** \class ContourSliceFilter
 * \brief Keeps the slices of a stack from which the others are best interpolated: more where sections change, fewer
 * where they do not.
 *
 * About height / MeanSpacing slices are kept. A slice that is left out is told from the two kept around it by
 * shape-based interpolation (S. P. Raya & J. K. Udupa, doi:10.1109/42.52980); the slices kept are those with the least
 * volume misplaced. With MeanSpacing 0, or one below the stack's own, all are kept. Slices before the first and after
 * the last contour are left out. Contours are copied as they are. Parameters: \ref ContourSliceParameters. Errors
 * (itk::ExceptionObject): as \ref ContourStackFilter; a parameter out of range. */
class ContourSliceFilter : public ContourStackFilter
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourSliceFilter);
  using Self = ContourSliceFilter;
  using Superclass = ContourStackFilter;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(ContourSliceFilter, ContourStackFilter);

  BONE_FILTER_PARAMETERS(ContourSliceParameters, BONE_CONTOUR_SLICE_PARAMETERS)

  /** After an update: volume misplaced between the slices kept, mm^3. */
  itkGetConstMacro(MisplacedVolume, double);

protected:
  ContourSliceFilter() = default;
  ~ContourSliceFilter() override = default;

  void
  VerifyPreconditions() const override;
  std::vector<std::size_t>
  ChooseSlices(const ContourStack & input, const Execution & execution) override;
  ContourSlice
  MakeSlice(const ContourStack & input, std::size_t k) override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  double m_MisplacedVolume{ 0.0 };
};
} // namespace bone

#endif
