/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLevelDensity.h"

#include "boneDensityFitKernel.h"
#include "boneTetraLocator.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
Barycentric
CoordinatesIn(const MeshArrays & mesh, IdType t, const Vector3 & x)
{
  const Id4 & v = mesh.tetrahedra[t];
  return BarycentricCoordinates(x, mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]);
}

Barycentric
Clamped(const Barycentric & mu)
{
  const Barycentric positive = mu.cwiseMax(0.0);
  return positive / positive.sum();
}

/** The sample of a cell that is nearest to x. */
int
NearestSample(const DensitySamples & samples, const std::vector<int> & candidates, const Vector3 & x)
{
  return *std::min_element(candidates.begin(), candidates.end(), [&](int a, int b) {
    return (samples.All()[a].x - x).squaredNorm() < (samples.All()[b].x - x).squaredNorm();
  });
}
} // namespace

void
RefitDensity(const MeshArrays &          before,
             MeshArrays &                level,
             const std::vector<IdType> & parentCell,
             const std::vector<IdType> & cellSlot,
             const DensitySamples &      samples,
             const std::vector<IdType> & sampleCell,
             const ParallelFor &         parallelFor)
{
  const int              degree = before.maximumDegree;
  const std::size_t      row = BernsteinCount(degree), count = level.tetrahedra.size();
  const DensityFitKernel kernel(degree, degree + 3);
  const auto &           pattern = kernel.SamplePoints();
  const TetraLocator     locator(before);
  level.maximumDegree = degree;
  level.quantity = before.quantity;
  level.degree.assign(count, degree);
  level.coefficients.assign(row * count, 0.0);
  parallelFor(count, [&](std::size_t t) {
    const IdType parent = parentCell[t];
    if (parent >= 0)
    {
      level.degree[t] = before.degree[parent];
      std::copy_n(&before.coefficients[row * parent], row, &level.coefficients[row * t]);
      return;
    }
    const Id4 &              v = level.tetrahedra[t];
    const std::vector<int> & candidates = samples.InCell(cellSlot[t]);
    std::vector<double>      values(pattern.size());
    IdType                   at = candidates.empty() ? sampleCell[0] : sampleCell[candidates.front()];
    for (std::size_t k = 0; k < pattern.size(); ++k)
    {
      const Barycentric & mu = pattern[k];
      const Vector3       x = mu[0] * level.points[v[0]] + mu[1] * level.points[v[1]] + mu[2] * level.points[v[2]] +
                        mu[3] * level.points[v[3]];
      if (!candidates.empty())
      {
        at = sampleCell[NearestSample(samples, candidates, x)];
      }
      const CellLocation place = locator.FindNearest(x, at);
      values[k] = BernsteinValue(before.degree[place.cell], &before.coefficients[row * place.cell], place.mu);
    }
    kernel.Fit(values.data(), &level.coefficients[row * t]);
  });
}

double
DensityError(const MeshArrays &          level,
             const std::vector<IdType> & cellSlot,
             const DensitySamples &      samples,
             const ParallelFor &         parallelFor)
{
  const std::size_t   row = BernsteinCount(level.maximumDegree);
  std::vector<double> squares(level.tetrahedra.size(), 0.0), weights(level.tetrahedra.size(), 0.0);
  parallelFor(level.tetrahedra.size(), [&](std::size_t t) {
    for (int s : samples.InCell(cellSlot[t]))
    {
      const auto &      sample = samples.All()[s];
      const Barycentric mu = Clamped(CoordinatesIn(level, static_cast<IdType>(t), sample.x));
      const double      error = BernsteinValue(level.degree[t], &level.coefficients[row * t], mu) - sample.value;
      squares[t] += sample.weight * error * error;
      weights[t] += sample.weight;
    }
  });
  double square = 0.0, weight = 0.0;
  for (std::size_t t = 0; t < squares.size(); ++t)
  {
    square += squares[t];
    weight += weights[t];
  }
  return weight > 0 ? std::sqrt(square / weight) : 0.0;
}
} // namespace bone
