/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourFilter_h
#define boneContourFilter_h

#include "boneContourStack.h"

#include <itkProcessObject.h>

namespace bone
{
/** \class ContourSource
 * \brief Base of the process objects whose primary output is a stack of contours. */
class ContourSource : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourSource);
  using Self = ContourSource;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(ContourSource, itk::ProcessObject);

  ContourStack *
  GetOutput()
  {
    return itkDynamicCastInDebugMode<ContourStack *>(this->GetPrimaryOutput());
  }
  const ContourStack *
  GetOutput() const
  {
    return itkDynamicCastInDebugMode<const ContourStack *>(this->GetPrimaryOutput());
  }

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType) override
  {
    return ContourStack::New().GetPointer();
  }

protected:
  ContourSource()
  {
    this->SetNumberOfRequiredOutputs(1);
    this->SetNthOutput(0, ContourStack::New());
  }
  ~ContourSource() override = default;
};

/** \class ContourFilter
 * \brief Base of the filters that make one stack of contours from another: the primary input is named "Contours". */
class ContourFilter : public ContourSource
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(ContourFilter);
  using Self = ContourFilter;
  using Superclass = ContourSource;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(ContourFilter, ContourSource);

  using itk::ProcessObject::SetInput;
  void
  SetInput(const ContourStack * contours)
  {
    this->SetPrimaryInput(const_cast<ContourStack *>(contours));
  }
  const ContourStack *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const ContourStack *>(this->GetPrimaryInput());
  }

protected:
  ContourFilter() { this->SetPrimaryInputName("Contours"); }
  ~ContourFilter() override = default;
};
} // namespace bone

#endif
