/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef bonePlacementFilter_h
#define bonePlacementFilter_h

#include "boneExecution.h"
#include "bonePlacement.h"

#include <itkObjectFactory.h>
#include <itkProcessObject.h>

namespace bone
{
/** \class PlacementFilter
 * \brief Puts contours or a hierarchy in their place (\ref Placement), as a step of a lazy pipeline.
 *
 * \tparam TData a ContourStack or a DensityHierarchy. */
template <typename TData>
class PlacementFilter : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(PlacementFilter);
  using Self = PlacementFilter;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(PlacementFilter, itk::ProcessObject);

  using itk::ProcessObject::SetInput;
  void
  SetInput(const TData * input)
  {
    this->SetPrimaryInput(const_cast<TData *>(input));
  }
  TData *
  GetOutput()
  {
    return itkDynamicCastInDebugMode<TData *>(this->GetPrimaryOutput());
  }

  /** Default: nothing is moved. */
  void
  SetPlacement(const Placement & placement)
  {
    if (placement != m_Placement)
    {
      m_Placement = placement;
      this->Modified();
    }
  }
  itkGetConstReferenceMacro(Placement, Placement);

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType) override
  {
    return TData::New().GetPointer();
  }

protected:
  PlacementFilter()
  {
    this->SetNumberOfRequiredInputs(1);
    this->SetNumberOfRequiredOutputs(1);
    this->SetNthOutput(0, TData::New());
  }
  ~PlacementFilter() override = default;
  void
  GenerateOutputInformation() override
  {}
  void
  GenerateData() override
  {
    this->GetOutput()->Graft(Place(*static_cast<const TData *>(this->GetPrimaryInput()), m_Placement));
    Execution(this).Report(1.0);
  }
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override
  {
    Superclass::PrintSelf(os, indent);
    os << indent << "Direction:\n" << m_Placement.direction << '\n';
    os << indent << "Origin: " << m_Placement.origin.transpose() << '\n';
  }

private:
  Placement m_Placement;
};
} // namespace bone

#endif
