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
 * A level ends at its number of tetrahedra, at its bound on the density error, on the distance of its surfaces or on
 * the volume of a region, or when nothing more is allowed; the level's stopReason says which: "tetrahedra reached",
 * "density error bound", "surface distance bound", "volume bound", "nothing more allowed". The density error is measured
 * after steps of 30 % of the cells; one beyond the bound is taken back and halved, down to half a percent. Where
 * MaximumDegree allows it, degrees are raised before that (paper 4.3). Levels that would be as large as the one before
 * are still made. A level's surfaceError is the largest distance of its surfaces to those of the first level, or back.
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
  /** Bounds on the distance of boundary and interfaces of the levels after the first to those of the first, and back,
   * mm, at every point of them (\ref SurfaceEnvelope); not descending; where there are fewer than levels, the rest have
   * none. */
  void
  SetMaximumSurfaceDistances(const std::vector<double> & distances);
  const std::vector<double> &
  GetMaximumSurfaceDistances() const
  {
    return m_MaximumSurfaceDistances;
  }
  /** Bound on the change of each region's volume, as a share of it; default 0.03. */
  itkSetMacro(MaximumVolumeChange, double);
  itkGetConstMacro(MaximumVolumeChange, double);
  /** Degree to which the polynomials of changed cells may be raised, those with the largest error first, so that a level
   * keeps to its bound on the density error; negative (the default): they keep the degree of the input. */
  itkSetMacro(MaximumDegree, int);
  itkGetConstMacro(MaximumDegree, int);
  /** No collapse takes a dihedral angle below this and below what was there, rad; default 3 degrees. */
  itkSetMacro(MinimumDihedralAngle, double);
  itkGetConstMacro(MinimumDihedralAngle, double);
  /** The same for cells of the cortical layer, which has room for less where it is thin; default 1.5 degrees. */
  itkSetMacro(MinimumCorticalDihedralAngle, double);
  itkGetConstMacro(MinimumCorticalDihedralAngle, double);
  /** Weights of the cost, see \ref MeshCollapser: of the density error, default 3; */
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
  std::vector<double>      m_MaximumSurfaceDistances;
  double                   m_MaximumVolumeChange{ 0.03 };
  double                   m_MinimumDihedralAngle{ CollapseParameters().minimumAngle };
  double                   m_MinimumCorticalDihedralAngle{ CollapseParameters().minimumCorticalAngle };
  int                      m_MaximumDegree{ -1 };
  double                   m_DensityWeight{ CollapseParameters().densityWeight };
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
