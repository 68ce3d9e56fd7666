/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeshToMeshFilter_h
#define boneMeshToMeshFilter_h

#include "boneDensityMesh.h"
#include "boneExecution.h"
#include "boneMeshFilter.h"
#include "boneTetraComplex.h"

namespace bone
{
/** \class MeshToMeshFilter
 * \brief Base of the filters that take a layered mesh and give a better one (paper 2.7).
 *
 * Input and output are of type TMesh (\ref DensityMesh). The output has no density: a polynomial holds for the cell it
 * was fitted in, so fit after this. Layers, slices and regions are kept. The work is done in double; where a mesh of
 * float coordinates cannot hold the result without an inverted cell, itk::ExceptionObject says so.
 *
 * Cells of the input that are flat or inverted are made positive first by moving inner and interface points (\ref
 * RepairInvertedCells). Throws itk::ExceptionObject where the input is missing, has no cells or points that are not
 * finite, lacks valid face neighbours, or where cells stay flat or inverted, with their number. */
template <typename TMesh>
class MeshToMeshFilter : public MeshFilter<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(MeshToMeshFilter);
  using Self = MeshToMeshFilter;
  using Superclass = MeshFilter<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkTypeMacro(MeshToMeshFilter, MeshFilter);

protected:
  MeshToMeshFilter() = default;
  ~MeshToMeshFilter() override = default;

  void
  GenerateData() final;

  /** Whether cells of the input that are flat or inverted are to be made positive, or else are taken as they are. */
  virtual bool
  NeedsPositiveCells() const
  {
    return true;
  }
  /** Does the filter's work. */
  virtual void
  Improve(TetraComplex & complex, const Execution & execution) = 0;

private:
  void
  MakePositive(const MeshArrays & input, TetraComplex & complex) const;
};
} // namespace bone

#ifndef ITK_MANUAL_INSTANTIATION
#include "boneMeshToMeshFilter.hxx"
#endif

#endif
