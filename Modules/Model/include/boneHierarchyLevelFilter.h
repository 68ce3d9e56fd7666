/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneHierarchyLevelFilter_h
#define boneHierarchyLevelFilter_h

#include "boneDensityHierarchy.h"
#include "boneMeshSource.h"

namespace bone
{
/** \class HierarchyLevelFilter
 * \brief Hands one level of a hierarchy on as a mesh, so that stages that take a mesh can follow TetraCollapseFilter in
 * a lazy pipeline. Throws itk::ExceptionObject where the input "Hierarchy" has no such level. */
class HierarchyLevelFilter : public MeshSource<DensityMesh<double>>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(HierarchyLevelFilter);
  using Self = HierarchyLevelFilter;
  using Superclass = MeshSource<DensityMesh<double>>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(HierarchyLevelFilter, MeshSource);

  using HierarchyType = DensityHierarchy<DensityMesh<double>>;

  using itk::ProcessObject::SetInput;
  void
  SetInput(const HierarchyType * hierarchy)
  {
    this->SetPrimaryInput(const_cast<HierarchyType *>(hierarchy));
  }

  /** 0 is the finest level; default 0. */
  itkSetMacro(Level, std::size_t);
  itkGetConstMacro(Level, std::size_t);

protected:
  HierarchyLevelFilter() { this->SetPrimaryInputName("Hierarchy"); }
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
