/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourStackFilter_h
#define boneContourStackFilter_h

#include "boneContourFilter.h"
#include "boneExecution.h"

namespace bone
{
/** \class ContourStackFilter
 * \brief Base of filters that make one stack of contours from another, slice by slice.
 *
 * Throws itk::ExceptionObject where the input "Contours" holds no contour or does not pass \ref ContourStack::Verify.
 * Slices are worked on in parallel; the result does not depend on the number of threads. */
class ContourStackFilter : public ContourFilter
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourStackFilter);
  using Self = ContourStackFilter;
  using Superclass = ContourFilter;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(ContourStackFilter, ContourFilter);

protected:
  ContourStackFilter() = default;
  ~ContourStackFilter() override = default;

  void
  GenerateData() override
  {
    this->MakeSlices(Execution(this));
  }

  /** Makes the output from the slices that ChooseSlices names. */
  void
  MakeSlices(const Execution & execution);

  /** The slices of the input that the output's are made from, ascending: all, unless overridden. */
  virtual std::vector<std::size_t>
  ChooseSlices(const ContourStack & input, const Execution & execution);

  /** The output's slice made from slice k of the input; called from many threads at once. */
  virtual ContourSlice
  MakeSlice(const ContourStack & input, std::size_t k) = 0;
};
} // namespace bone

#endif
