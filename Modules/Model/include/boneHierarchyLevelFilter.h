/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneHierarchyLevelFilter_h
#define boneHierarchyLevelFilter_h

#include "boneDensityHierarchy.h"

#include <itkProcessObject.h>

namespace bone
{
/** \class HierarchyLevelFilter
 * \brief Hands one level of a hierarchy on as a mesh, so that stages that take a mesh can follow TetraCollapseFilter in
 * a lazy pipeline. Throws itk::ExceptionObject where the hierarchy has no such level. */
class HierarchyLevelFilter : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(HierarchyLevelFilter);
  using Self = HierarchyLevelFilter;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  itkNewMacro(Self);
  itkTypeMacro(HierarchyLevelFilter, itk::ProcessObject);

  using MeshType = DensityMesh<double>;
  using HierarchyType = DensityHierarchy<MeshType>;

  using Superclass::SetInput;
  void
  SetInput(const HierarchyType * hierarchy);
  MeshType *
  GetOutput();

  /** 0 is the finest level; default 0. */
  itkSetMacro(Level, std::size_t);
  itkGetConstMacro(Level, std::size_t);

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override;

protected:
  HierarchyLevelFilter();
  ~HierarchyLevelFilter() override = default;
  /** A mesh's information does not follow from that of a hierarchy. */
  void
  GenerateOutputInformation() override
  {}
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  std::size_t m_Level{ 0 };
};
} // namespace bone

#endif
