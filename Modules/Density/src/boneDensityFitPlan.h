/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityFitPlan_h
#define boneDensityFitPlan_h

#include "boneDensityFitKernel.h"
#include "boneMeshArrays.h"

#include <memory>
#include <vector>

namespace bone
{
/** \class DensityFitPlan
 * \brief Which sample pattern each tetrahedron gets, and batches of tetrahedra that share one.
 *
 * A pattern has at least PointsPerCoefficient points for each coefficient and PointsPerVoxel for each voxel in the
 * tetrahedron, so that the fit sees all voxels of large ones; above LargestLattice it grows no more. Kernels are made
 * once for each pattern that occurs. The plan does not depend on the number of threads. */
class DensityFitPlan
{
public:
  // On CT, with fewer points high degrees oscillate between them, and with more the error hardly falls.
  static constexpr double      PointsPerCoefficient = 4.0;
  static constexpr double      PointsPerVoxel = 4.0;
  static constexpr int         LargestLattice = 20; // 1771 points
  static constexpr std::size_t BatchSize = 32;

  /** Tetrahedra of one pattern that are fitted together. */
  struct Batch
  {
    const DensityFitKernel * kernel;
    std::vector<IdType>      tetrahedra;
  };

  /** For the given tetrahedra of the mesh. `tikhonov` is the kernels'. Throws as DensityFitKernel. */
  DensityFitPlan(const MeshArrays &          mesh,
                 const std::vector<IdType> & tetrahedra,
                 double                      voxelVolume,
                 int                         degree,
                 double                      tikhonov);

  const std::vector<Batch> &
  GetBatches() const
  {
    return m_Batches;
  }

  /** Sample points of all tetrahedra together. */
  std::size_t
  GetNumberOfSamples() const;

private:
  std::vector<std::unique_ptr<DensityFitKernel>> m_Kernels;
  std::vector<Batch>                             m_Batches;
};
} // namespace bone

#endif
