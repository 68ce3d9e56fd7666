/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTetraSwapFilter_h
#define boneTetraSwapFilter_h

#include "boneMeshToMeshFilter.h"
#include "boneTetraFlips.h"

namespace bone
{
/** \class TetraSwapFilter
 * \brief Swaps faces and edges of a tetrahedral mesh where that makes its worst cells better (paper 2.7).
 *
 * 2-3, 3-2 and 4-4 flips and edge removal, inside a region only: boundary, interfaces and points stay as they are. Each
 * flip strictly raises the smallest dihedral angle of the cells it touches, and new cells are positive (exact).
 * Sequential, the worst cell first: the result does not depend on threads. Parameters: \ref
 * TetraSwapParameters. Errors: \ref MeshToMeshFilter. */
template <typename TMesh = DensityMesh<double>>
class TetraSwapFilter : public MeshToMeshFilter<TMesh>
{
public:
  ITK_DISALLOW_COPY_AND_MOVE(TetraSwapFilter);
  using Self = TetraSwapFilter;
  using Superclass = MeshToMeshFilter<TMesh>;
  using Pointer = itk::SmartPointer<Self>;
  using ConstPointer = itk::SmartPointer<const Self>;
  itkNewMacro(Self);
  itkTypeMacro(TetraSwapFilter, MeshToMeshFilter);

  BONE_PLAIN_FILTER_PARAMETERS(TetraSwapParameters, BONE_TETRA_SWAP_PARAMETERS)

  /** What the last run did. */
  itkGetConstReferenceMacro(Report, FlipReport);

protected:
  TetraSwapFilter() = default;
  ~TetraSwapFilter() override = default;
  void
  Improve(TetraComplex & complex, const Execution & execution) override
  {
    FlipParameters parameters;
    static_cast<TetraSwapParameters &>(parameters) = this->GetParameters();
    m_Report = ImproveByFlips(complex, parameters, {}, nullptr, execution);
  }

private:
  FlipReport m_Report;
};

extern template class TetraSwapFilter<DensityMesh<double>>;
} // namespace bone

#endif
