/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshQualityFilter_h
#define boneMeshQualityFilter_h

#include "boneMeshToMeshFilter.h"

#include <cmath>

namespace bone
{
/** \class MeshQualityFilter
 * \brief Makes a tiled mesh fit for computing: smoothing, swaps and optimisation in turn (paper 2.7).
 *
 * Each round smooths (\ref TetraSmoothingFilter, Enhanced; two iterations after the first round), swaps (\ref
 * TetraSwapFilter) and moves the points of the worst cells by a pattern search that raises the smallest dihedral angle
 * around the point. Boundary, interfaces, rims and flat cuts are kept within DistanceBound throughout, and a valid mesh
 * stays valid. The number of cells may change a little, that of points does not.
 * Sequential: the result does not depend on threads. Errors: \ref MeshToMeshFilter. */
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

  /** Smoothing iterations of the first round; default 10. */
  itkSetMacro(Iterations, int);
  itkGetConstMacro(Iterations, int);
  /** How far boundary and interfaces may be faired, mm; default 0.3. */
  itkSetMacro(DistanceBound, double);
  itkGetConstMacro(DistanceBound, double);
  /** Pairs of Taubin steps that fair the surfaces; default 10. */
  itkSetMacro(FairingIterations, int);
  itkGetConstMacro(FairingIterations, int);
  /** Rounds of smoothing, swaps and optimisation; default 3. */
  itkSetMacro(Rounds, int);
  itkGetConstMacro(Rounds, int);
  /** Cells with a dihedral angle below are swapped and optimised, rad; default 0.44 (25 degrees). */
  itkSetMacro(TargetAngle, double);
  itkGetConstMacro(TargetAngle, double);
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
  int               m_Iterations{ 10 };
  double            m_DistanceBound{ 0.3 };
  int               m_FairingIterations{ 10 };
  int               m_Rounds{ 3 };
  double            m_TargetAngle{ 0.44 };
  int               m_OptimizationPasses{ 2 };
  ImprovementReport m_Report;
};

extern template class MeshQualityFilter<DensityMesh<double>>;
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneMeshQualityFilter.hxx"
#endif

#endif
