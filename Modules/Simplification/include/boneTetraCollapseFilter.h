/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraCollapseFilter_h
#define boneTetraCollapseFilter_h

#include "boneDensityHierarchy.h"
#include "boneDensityMesh.h"
#include "boneTetraCollapseParameters.h"
#include "boneTetraComplex.h"

#include <itkProcessObject.h>

#include <array>

namespace bone
{
/** \class TetraCollapseFilter
 * \brief Simplifies a layered density mesh by edge collapse into a hierarchy of levels (paper 4).
 *
 * Input: a valid mesh (primary, "Mesh"), with or without density. Output: a \ref DensityHierarchy whose first level is
 * the input and whose points are, level by level, a subset of those of the level before (with ImproveAngles, moved).
 *
 * Half-edge collapses are taken from a priority queue. No collapse crosses layers, leaves a boundary, an interface or
 * the rim of a flat cut, changes the topology of the body or of one of its surfaces, inverts a cell, or lets the
 * boundary pass through itself. The error of the density is always measured against the first level. Cells that change
 * are fitted again, at each level's end, to samples of the level before. Flips raise the smallest dihedral angles;
 * points stay where they are, unless ImproveAngles is on: then, when a level is reached, points move and edges of
 * surfaces are flipped so that the sum of all cells' smallest angles rises, from which it is taken how far surfaces lie
 * from the first level's, how far volumes are from theirs, and what cells lack of WantedDihedralAngle (in the cortical
 * layer of WantedCorticalDihedralAngle), more and more of that until none is below. That is for finite elements, whose
 * stiffness matrices small angles spoil (J. R. Shewchuk, "What is a good linear finite element?", 2002); long cells,
 * which are too stiff in bending, are avoided for the same reason.
 *
 * A level ends at its number of tetrahedra, at its bound on the density error, on the distance of its surfaces or on
 * the volume of a region, or when nothing more is allowed; the level's stopReason says which: "tetrahedra reached",
 * "density error bound", "cell error bound", "surface distance bound", "volume bound", "nothing more allowed". The
 * density error is measured after steps of 30 % of the cells; a step beyond the bound is taken back and halved, down to
 * half a percent. Where MaximumDegree allows it, degrees are raised before that (paper 4.3). MaximumCellErrors are
 * bounds as the paper has them: on the root mean square difference between each new cell's polynomial and the first
 * level's density within the cell, at 64 points that are not those of its fit. Cells are then fitted to the first
 * level, collapses and flips that leave a cell beyond the bound are refused, and degrees are raised where MaximumDegree
 * allows it. Levels that would be as large as the one before are still made. A level's surfaceError is the largest
 * distance of its surfaces to those of the first level, or back.
 *
 * Parameters: \ref TetraCollapseParameters. There are as many levels after the first as the longest of Levels,
 * MaximumDensityErrors, MaximumCellErrors and MaximumSurfaceDistances has elements; the last two cannot be had with
 * ImproveAngles; where one of these is shorter, the rest of the levels
 * have no such number or bound. Levels must not ascend; bounds must not descend. MaximumSurfaceDistances hold at every
 * point of the surfaces. With MaximumDegree the polynomials of the changed cells with the largest error are raised
 * first. An angle of the input that is below MinimumDihedralAngle may stay. The weights are those of the cost of a
 * collapse, in mm^3; the formula is in src/boneMeshCollapser.h.
 *
 * Collapses are sequential, fits are threaded by cell: the result is the same for any number of threads.
 *
 * Throws itk::ExceptionObject without input, without levels, for an input that is not valid (the message is that of
 * \ref ValidateMesh), for a parameter out of its range, and for a bound on the density error where the input has no
 * density. */
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
  SetInput(const TMesh * mesh)
  {
    this->SetPrimaryInput(const_cast<TMesh *>(mesh));
  }
  const TMesh *
  GetInput() const
  {
    return itkDynamicCastInDebugMode<const TMesh *>(this->GetPrimaryInput());
  }
  HierarchyType *
  GetOutput()
  {
    return itkDynamicCastInDebugMode<HierarchyType *>(this->GetPrimaryOutput());
  }
  const HierarchyType *
  GetOutput() const
  {
    return itkDynamicCastInDebugMode<const HierarchyType *>(this->GetPrimaryOutput());
  }

  BONE_FILTER_PARAMETERS(TetraCollapseParameters, BONE_TETRA_COLLAPSE_PARAMETERS)

  /** What was done for each level after the first: collapses, and refusals by reason. */
  struct LevelReport
  {
    std::size_t                                 collapses;
    std::array<std::size_t, MeshOperationCount> refused;
    double                                      cellError; ///< largest of a cell that has changed; 0 without bounds
  };
  itkGetConstReferenceMacro(Report, std::vector<LevelReport>);

  using Superclass::MakeOutput;
  itk::DataObject::Pointer
  MakeOutput(itk::ProcessObject::DataObjectPointerArraySizeType) override
  {
    return HierarchyType::New().GetPointer();
  }

protected:
  TetraCollapseFilter();
  ~TetraCollapseFilter() override = default;
  void
  VerifyPreconditions() const override;
  void
  GenerateData() override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  std::vector<LevelReport> m_Report;
};

extern template class TetraCollapseFilter<DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneTetraCollapseFilter.hxx"
#endif

#endif
