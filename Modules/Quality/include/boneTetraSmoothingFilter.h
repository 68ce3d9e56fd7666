/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraSmoothingFilter_h
#define boneTetraSmoothingFilter_h

#include "boneMeshToMeshFilter.h"
#include "boneSmoothingKernel.h"

namespace bone
{
/** \class TetraSmoothingFilter
 * \brief Smooths a layered tetrahedral mesh without shrinking it, inverting cells or mixing layers (paper 2.7).
 *
 * Enhanced (default): v' = proj(mean of the neighbours). Inner points take all neighbours; points of the boundary or an
 * interface those along it, and the mean is put back on that surface, which was faired first by no more than
 * DistanceBound; points of curves, where interfaces meet or a flat cut has its rim, stay on their
 * curve, and points where curves meet stay. Where a tetrahedron would not be positive (exact), where a dihedral angle
 * would fall both below AngleFloor and below what it was, or where the boundary would pass through itself, the new
 * place is weighted back, v(k) = proj(Weight v + (1 - Weight) v(k-1)), a few times, and the point stays if nothing
 * helps. A valid mesh stays valid, its flat cuts flat, and its boundary and interfaces within DistanceBound.
 *
 * Laplacian and Smart are the plain forms that the paper compares with: the mean of all neighbours for all points,
 * without and with a test for inversion. Both shrink the body, and Laplacian may invert cells.
 *
 * Sequential in ascending order of points: the result does not depend on threads. Parameters: \ref
 * TetraSmoothingParameters. Errors, and what is done about inverted cells of the input: \ref MeshToMeshFilter.
 * Laplacian takes those as they are. */
template <typename TMesh = DensityMesh<double>>
class TetraSmoothingFilter : public MeshToMeshFilter<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(TetraSmoothingFilter);
  using Self = TetraSmoothingFilter;
  using Superclass = MeshToMeshFilter<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(TetraSmoothingFilter, MeshToMeshFilter);

  BONE_PLAIN_FILTER_PARAMETERS(TetraSmoothingParameters, BONE_TETRA_SMOOTHING_PARAMETERS)

  /** What the last run did. */
  itkGetConstReferenceMacro(Report, SmoothingReport);

protected:
  TetraSmoothingFilter() = default;
  ~TetraSmoothingFilter() override = default;
  void
  Improve(TetraComplex & complex, const Execution & execution) override
  {
    m_Report = SmoothPoints(complex, this->GetParameters(), execution);
  }
  bool
  NeedsPositiveCells() const override
  {
    return this->GetMethod() != SmoothingMethod::Laplacian;
  }

private:
  SmoothingReport m_Report;
};

extern template class TetraSmoothingFilter<DensityMesh<double>>;
} // namespace bone

#endif
