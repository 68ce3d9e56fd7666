/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraCollapseFilter_h
#define boneTetraCollapseFilter_h

#include "boneDensityHierarchy.h"
#include "boneHierarchyBuilder.h"

#include <itkMultiThreaderBase.h>
#include <itkProcessObject.h>

#include <limits>

namespace bone
{
/** \class TetraCollapseFilter
 * \brief Simplifies a layered density mesh by edge collapse into a hierarchy of levels (paper 4).
 *
 * Input: a valid mesh of type TMesh, with or without density. Output: a \ref DensityHierarchy whose first level is the
 * input and whose points are, level by level, a subset of those of the level before.
 *
 * Half-edge collapses are taken from a priority queue (\ref MeshCollapser, where cost and refusals are written down):
 * none crosses layers, leaves a boundary, an interface or the rim of a flat cut, changes the topology of the body or of
 * one of its surfaces, inverts a cell, or lets the boundary pass through itself. The error of the density is always
 * measured against the first level. Cells that change are fitted again, at each level's end, to samples of the level
 * before. Flips make the worst cells better; points stay where they are.
 *
 * A level ends at its number of tetrahedra, at its bound on the density error (checked after every 6 % of the cells,
 * the last step being taken back), or when the bounds on surfaces and quality allow nothing more; the level's
 * stopReason says which. Levels that would be as large as the one before are still made.
 *
 * Collapses are sequential, fits are threaded by cell: the result is the same for any number of threads.
 *
 * Throws itk::ExceptionObject without input, without levels, for an input that is not valid (the message is that of
 * \ref ValidateMesh), and for a bound on the density error where the input has no density. */
template <typename TMesh = DensityMesh<double>>
class TetraCollapseFilter : public itk::ProcessObject
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(TetraCollapseFilter);
  using Self = TetraCollapseFilter;
  using Superclass = itk::ProcessObject;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(TetraCollapseFilter, itk::ProcessObject);
  using MeshType = TMesh;
  using HierarchyType = DensityHierarchy<TMesh>;

  using Superclass::SetInput;
  void
  SetInput(const TMesh * mesh);
  const TMesh *
  GetInput() const;
  HierarchyType *
  GetOutput();
  const HierarchyType *
  GetOutput() const;

  /** Numbers of tetrahedra of the levels after the first, not ascending; empty: bounds alone decide. */
  void
  SetLevels(const std::vector<IdType> & levels);
  const std::vector<IdType> &
  GetLevels() const
  {
    return m_Levels;
  }
  /** Bounds on the root mean square density error of the levels after the first, density units, not descending; where
   * there are fewer than levels, the rest have none. */
  void
  SetMaximumDensityErrors(const std::vector<double> & errors);
  const std::vector<double> &
  GetMaximumDensityErrors() const
  {
    return m_MaximumDensityErrors;
  }
  /** Bound on the distance of every removed point of boundary and interfaces to its surface, mm; default infinity. */
  itkSetMacro(MaximumSurfaceDistance, double);
  itkGetConstMacro(MaximumSurfaceDistance, double);
  /** Bound on the change of each region's volume, as a share of it; default infinity. */
  itkSetMacro(MaximumVolumeChange, double);
  itkGetConstMacro(MaximumVolumeChange, double);
  /** No collapse takes a dihedral angle below this and below what it was, rad; default 0.052 (3 degrees). */
  itkSetMacro(MinimumDihedralAngle, double);
  itkGetConstMacro(MinimumDihedralAngle, double);
  /** Weights of the cost, see \ref MeshCollapser: of the density error, default 1; */
  itkSetMacro(DensityWeight, double);
  itkGetConstMacro(DensityWeight, double);
  /** of the distance of boundary and interfaces, 1/mm, default 1; */
  itkSetMacro(SurfaceWeight, double);
  itkGetConstMacro(SurfaceWeight, double);
  /** of the change of regions' volumes, default 200. */
  itkSetMacro(VolumeWeight, double);
  itkGetConstMacro(VolumeWeight, double);

  /** What was done for each level after the first: collapses, and refusals by reason. */
  struct LevelReport
  {
    std::size_t                                 collapses;
    std::array<std::size_t, MeshOperationCount> refused;
  };
  const std::vector<LevelReport> &
  GetReport() const
  {
    return m_Report;
  }

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType index) override;

protected:
  TetraCollapseFilter();
  ~TetraCollapseFilter() override = default;
  void
  VerifyPreconditions() ITKv5_CONST override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  CollapseParameters
  MakeParameters() const;
  std::vector<LevelRequest>
  MakeRequests() const;

  std::vector<IdType>      m_Levels;
  std::vector<double>      m_MaximumDensityErrors;
  double                   m_MaximumSurfaceDistance{ std::numeric_limits<double>::infinity() };
  double                   m_MaximumVolumeChange{ std::numeric_limits<double>::infinity() };
  double                   m_MinimumDihedralAngle{ 0.052 };
  double                   m_DensityWeight{ 1.0 };
  double                   m_SurfaceWeight{ 1.0 };
  double                   m_VolumeWeight{ 200.0 };
  std::vector<LevelReport> m_Report;
};

extern template class TetraCollapseFilter<DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneTetraCollapseFilter.hxx"
#endif

#endif
