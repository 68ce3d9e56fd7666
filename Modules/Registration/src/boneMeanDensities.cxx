/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeanDensities.h"

#include "boneBernstein.h"
#include "boneMeshValidator.h"

#include <numeric>

namespace bone
{
MeshArrays
WithMeanDensities(const MeshArrays & mesh)
{
  MeshArrays means = mesh;
  means.maximumDegree = 0;
  means.degree.assign(mesh.tetrahedra.size(), 0);
  means.coefficients.resize(mesh.tetrahedra.size());
  const auto row = static_cast<std::size_t>(BernsteinCount(mesh.maximumDegree));
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    const int      count = BernsteinCount(mesh.degree[t]);
    const double * first = &mesh.coefficients[t * row];
    means.coefficients[t] = std::accumulate(first, first + count, 0.0) / count;
  }
  return means;
}

BuiltLevel
SimplifyMeans(const MeshArrays & mesh, std::size_t tetrahedra, const Execution & execution)
{
  MeshArrays means = WithMeanDensities(mesh);
  if (tetrahedra < mesh.tetrahedra.size() && ValidateMesh(mesh).IsValid())
  {
    TetraCollapseParameters parameters;
    parameters.levels = { static_cast<IdType>(tetrahedra) };
    return std::move(BuildLevels(means, parameters, execution).front());
  }
  BuiltLevel same;
  same.mesh = std::move(means);
  same.parentPoint.resize(mesh.points.size());
  std::iota(same.parentPoint.begin(), same.parentPoint.end(), IdType{ 0 });
  return same;
}
} // namespace bone
