/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshQualityFilter_h
#define boneMeshQualityFilter_h

#include "boneMeshImprovement.h"
#include "boneMeshToMeshFilter.h"

#include <cmath>

namespace bone
{
/** \class MeshQualityFilter
 * \brief Makes a tiled mesh fit for computing: smoothing, swaps and optimisation in turn (paper 2.7).
 *
 * Boundary and interfaces are faired by at most DistanceBound; then each round smooths inner points, adds and removes
 * points inside regions until cells grow from the surfaces inward by Gradation, swaps faces and edges, and looks after
 * the worst cells: flips of surface edges, edge collapses, and a pattern search for their points. Each of these raises
 * the smallest dihedral angle of what it touches. In the end boundary and interfaces are fitted to the first ones, with
 * a resistance to bending, and regions get their volumes back. A valid mesh stays valid, flat cuts flat, layers what
 * they are.
 *
 * Surfaces stay within DistanceBound of the first ones and these within DistanceBound of them, as measured at the
 * corners, centroid and three more points of each triangle; where no change within it mends a cell with an angle below
 * 10 degrees, within 1.5 times that. Within SliverFactor times that where the angle is below 5 degrees, and where
 * surfaces are fitted, as contours that the mesh has left out may be that far from it.
 *
 * Optional input "Contours": what the mesh was tiled from, best before slices were left out and contours resampled.
 * Surfaces are then fitted to the contours (\ref FitSurfaces), and their edges flipped where that brings contours
 * closer or makes the surface turn less (\ref FlipToContours).
 *
 * Optional input "LabelImage", on any grid: the bone, as voxels. The boundary is fitted to the outline of `Label` too,
 * most of all between slices, where contours do not know it; and where it passes the centre of a voxel on the wrong
 * side by less than a sixteenth of a voxel, it is put on the right one (\ref SideKeeper).
 *
 * The numbers of cells and points change. A point that was added within region r has layer r, as a medial axis there,
 * and the slice of a neighbour. Sequential: the result does not depend on threads. Errors: \ref MeshToMeshFilter. */
template <typename TMesh = DensityMesh<double>>
class MeshQualityFilter : public MeshToMeshFilter<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(MeshQualityFilter);
  using Self = MeshQualityFilter;
  using Superclass = MeshToMeshFilter<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(MeshQualityFilter, MeshToMeshFilter);

  void
  SetContours(const ContourStack * contours);
  const ContourStack *
  GetContours() const;

  using LabelImageType = itk::Image<short, 3>;
  void
  SetLabelImage(const LabelImageType * labels);
  const LabelImageType *
  GetLabelImage() const;
  /** The bone's label; default 0: all labels but 0. */
  itkSetMacro(Label, short);
  itkGetConstMacro(Label, short);

  /** Smoothing iterations at the start; default 4. */
  itkSetMacro(Iterations, int);
  itkGetConstMacro(Iterations, int);
  /** How far boundary and interfaces may be from the first ones, mm; default 0.3. 0: they stay as they are. */
  itkSetMacro(DistanceBound, double);
  itkGetConstMacro(DistanceBound, double);
  /** Steps that fair the surfaces; default 10. */
  itkSetMacro(FairingIterations, int);
  itkGetConstMacro(FairingIterations, int);
  /** Rounds of smoothing, swaps, repair and optimisation; default 4. */
  itkSetMacro(Rounds, int);
  itkGetConstMacro(Rounds, int);
  /** Cells with a dihedral angle below are swapped and their inner points optimised, rad; default 0.44 (25 degrees). */
  itkSetMacro(TargetAngle, double);
  itkGetConstMacro(TargetAngle, double);
  /** How cells grow inward from the surfaces, mm a mm; default 0.65. 0: no points are added. */
  itkSetMacro(Gradation, double);
  itkGetConstMacro(Gradation, double);
  /** Passes of optimisation a round; default 1. */
  itkSetMacro(OptimizationPasses, int);
  itkGetConstMacro(OptimizationPasses, int);
  /** How many times DistanceBound surfaces may go to mend the worst cells, at least 1; default 4. */
  itkSetMacro(SliverFactor, double);
  itkGetConstMacro(SliverFactor, double);
  /** Resistance of surfaces to bending where they are fitted (\ref SurfaceBending), without unit: the larger, the
   * smoother and the farther from the first ones or the contours; default 0.08, 0: none. */
  itkSetMacro(Stiffness, double);
  itkGetConstMacro(Stiffness, double);
  /** What the last run did. */
  const ImprovementReport &
  GetReport() const
  {
    return m_Report;
  }

protected:
  MeshQualityFilter() = default;
  ~MeshQualityFilter() override = default;
  void
  VerifyPreconditions() ITKv5_CONST override;
  void
  Improve(TetraComplex & complex, const ProgressFunction & progress) override;
  void
  PrintSelf(std::ostream & os, itk::Indent indent) const override;

private:
  short             m_Label{ 0 };
  int               m_Iterations{ 4 };
  double            m_DistanceBound{ 0.3 };
  int               m_FairingIterations{ 10 };
  int               m_Rounds{ 4 };
  double            m_TargetAngle{ 0.44 };
  double            m_Gradation{ 0.65 };
  int               m_OptimizationPasses{ 1 };
  double            m_SliverFactor{ 4.0 };
  double            m_Stiffness{ 0.08 };
  ImprovementReport m_Report;
};

extern template class MeshQualityFilter<DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneMeshQualityFilter.hxx"
#endif

#endif
