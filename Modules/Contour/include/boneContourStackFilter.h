/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourStackFilter_h
#define boneContourStackFilter_h

#include "boneContourStack.h"
#include "boneLabelField.h"

#include <itkProcessObject.h>

namespace bone
{
/** \class ContourStackFilter
 * \brief Base of filters that make one stack of contours from another, slice by slice.
 *
 * Throws itk::ExceptionObject where the input holds no slice or does not pass \ref ContourStack::Verify. Slices are
 * worked on in parallel; the result does not depend on the number of threads. */
template <typename TContourStack>
class ContourStackFilter : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourStackFilter);
  using Self = ContourStackFilter;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(ContourStackFilter, itk::ProcessObject);
  using ContourStackType = TContourStack;

  using Superclass::SetInput;
  void
  SetInput(const TContourStack * contours);
  const TContourStack *
  GetInput() const;
  TContourStack *
  GetOutput();
  const TContourStack *
  GetOutput() const;

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override;

protected:
  ContourStackFilter();
  ~ContourStackFilter() override = default;

  /** Throws where a value is not positive (or, allowed, 0), naming it. */
  void
  CheckParameter(const char * name, double value, bool zeroAllowed = false) const;

  void
  GenerateData() override;

  /** The slices of the input that the output's are made from, ascending: all, unless overridden. */
  virtual std::vector<std::size_t>
  ChooseSlices(const TContourStack & input);

  /** The output's slice made from slice k of the input; called from many threads at once. */
  virtual ContourSlice
  MakeSlice(const TContourStack & input, std::size_t k) = 0;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneContourStackFilter.hxx"
#endif

#endif
