/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityFitPlan.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace bone
{
DensityFitPlan::DensityFitPlan(const MeshArrays &          mesh,
                               const std::vector<IdType> & tetrahedra,
                               double                      voxelVolume,
                               int                         degree,
                               double                      tikhonov)
{
  std::map<int, std::vector<IdType>> cellsOfLattice;
  for (const IdType t : tetrahedra)
  {
    const Id4 &  v = mesh.tetrahedra[t];
    const double volume =
      std::abs(SignedVolume(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]));
    const double points =
      std::max(PointsPerCoefficient * BernsteinCount(degree), PointsPerVoxel * volume / voxelVolume);
    const int lattice = DensityFitKernel::LatticeWithPoints(degree, points, LargestLattice);
    cellsOfLattice[lattice].push_back(t);
  }
  for (const auto & [lattice, cells] : cellsOfLattice)
  {
    m_Kernels.push_back(std::make_unique<DensityFitKernel>(degree, lattice, tikhonov));
    for (std::size_t begin = 0; begin < cells.size(); begin += BatchSize)
    {
      const std::size_t end = std::min(begin + BatchSize, cells.size());
      m_Batches.push_back({ m_Kernels.back().get(), { cells.begin() + begin, cells.begin() + end } });
    }
  }
}

std::size_t
DensityFitPlan::GetNumberOfSamples() const
{
  std::size_t samples = 0;
  for (const Batch & batch : m_Batches)
  {
    samples += batch.tetrahedra.size() * batch.kernel->SamplePoints().size();
  }
  return samples;
}
} // namespace bone
