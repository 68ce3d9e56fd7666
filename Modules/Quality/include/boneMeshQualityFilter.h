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
 * the smallest dihedral angle of what it touches; new triangles of boundary and interfaces stay within DistanceBound of
 * the first ones, and regions keep their volumes. A valid mesh stays valid, flat cuts flat, layers what they are.
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

  /** Smoothing iterations at the start; default 4. */
  itkSetMacro(Iterations, int);
  itkGetConstMacro(Iterations, int);
  /** How far boundary and interfaces may be faired and their triangles changed, mm; default 0.3. */
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
  /** How cells grow inward from the surfaces, mm a mm; default 0.7. 0: no points are added. */
  itkSetMacro(Gradation, double);
  itkGetConstMacro(Gradation, double);
  /** Passes of optimisation a round; default 2. */
  itkSetMacro(OptimizationPasses, int);
  itkGetConstMacro(OptimizationPasses, int);
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
  int               m_Iterations{ 4 };
  double            m_DistanceBound{ 0.3 };
  int               m_FairingIterations{ 10 };
  int               m_Rounds{ 4 };
  double            m_TargetAngle{ 0.44 };
  double            m_Gradation{ 0.7 };
  int               m_OptimizationPasses{ 2 };
  ImprovementReport m_Report;
};

extern template class MeshQualityFilter<DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneMeshQualityFilter.hxx"
#endif

#endif
