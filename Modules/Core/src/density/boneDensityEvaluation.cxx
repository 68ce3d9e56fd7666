/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensityEvaluation.h"

#include "boneDensityRaster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace bone
{
namespace
{
const double *
Row(const MeshArrays & mesh, std::size_t t)
{
  return &mesh.coefficients[t * BernsteinCount(mesh.maximumDegree)];
}

double
Volume(const MeshArrays & mesh, std::size_t t)
{
  const Id4 & v = mesh.tetrahedra[t];
  return SignedVolume(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]);
}

/** As numpy.percentile: linear between order statistics. Reorders the values, which must not be empty. */
double
Percentile(std::vector<float> & values, double percent)
{
  const double position = percent / 100 * static_cast<double>(values.size() - 1);
  const auto   low = static_cast<std::ptrdiff_t>(position);
  std::nth_element(values.begin(), values.begin() + low, values.end());
  const double below = values[low];
  const double above = low + 1 < static_cast<std::ptrdiff_t>(values.size())
                         ? *std::min_element(values.begin() + low + 1, values.end())
                         : below;
  return below + (position - static_cast<double>(low)) * (above - below);
}

/** What one slice adds to a comparison. */
struct SliceSums
{
  std::size_t        uncovered{ 0 };
  double             absolute{ 0.0 };
  double             square{ 0.0 };
  double             difference{ 0.0 };
  std::vector<float> reference;
};

SliceSums
CompareSlice(const DensityRaster & raster, const VoxelGrid & grid, int k, const VoxelReference & reference)
{
  SliceSums           sums;
  const std::size_t   size = static_cast<std::size_t>(grid.size[0]) * grid.size[1];
  std::vector<double> values(size);
  std::vector<IdType> cells(size);
  raster.FillSlice(k, 0.0, values.data(), cells.data());
  for (std::size_t v = 0; v < size; ++v)
  {
    double truth = 0;
    if (!reference(k * size + v, truth))
    {
      continue;
    }
    if (cells[v] < 0)
    {
      ++sums.uncovered;
      continue;
    }
    const double difference = values[v] - truth;
    sums.absolute += std::abs(difference);
    sums.square += difference * difference;
    sums.difference += difference;
    sums.reference.push_back(static_cast<float>(truth));
  }
  return sums;
}
} // namespace

double
DensityAt(const MeshArrays & mesh, const CellLocation & place)
{
  return BernsteinValue(mesh.degree[place.cell], Row(mesh, place.cell), place.mu);
}

Vector3
DensityGradientAt(const MeshArrays & mesh, const CellLocation & place)
{
  const Id4 & v = mesh.tetrahedra[place.cell];
  return BernsteinGradient(mesh.degree[place.cell],
                           Row(mesh, place.cell),
                           place.mu,
                           mesh.points[v[0]],
                           mesh.points[v[1]],
                           mesh.points[v[2]],
                           mesh.points[v[3]]);
}

std::vector<DensityProfilePoint>
DensityProfile(const MeshArrays &   mesh,
               const TetraLocator & locator,
               const Vector3 &      from,
               const Vector3 &      to,
               std::size_t          count)
{
  if (!mesh.HasDensity())
  {
    throw std::invalid_argument("The mesh holds no density: fit one first.");
  }
  if (count < 2)
  {
    throw std::invalid_argument("A profile needs two places or more.");
  }
  std::vector<DensityProfilePoint> profile(count);
  CellLocation                     place;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double          share = static_cast<double>(i) / static_cast<double>(count - 1);
    DensityProfilePoint & p = profile[i];
    p.point = (1 - share) * from + share * to;
    p.distance = share * (to - from).norm();
    place = locator.Find(p.point, place.cell);
    p.cell = place.cell;
    p.value = place.Found() ? DensityAt(mesh, place) : std::numeric_limits<double>::quiet_NaN();
    p.gradient = place.Found() ? DensityGradientAt(mesh, place) : Vector3::Constant(p.value);
  }
  return profile;
}

const char *
RegionName(int region)
{
  switch (region)
  {
    case Region::Outside:
      return "outside";
    case Region::Cortical:
      return "cortical";
    case Region::Trabecular:
      return "trabecular";
    case Region::Medullary:
      return "medullary";
    default:
      return "further layer";
  }
}

std::string
DensityUnitName(DensityQuantity quantity)
{
  return quantity == DensityQuantity::Unknown ? "density units" : DensityQuantityName(quantity);
}

std::vector<RegionDensity>
MeasureRegions(const MeshArrays & mesh)
{
  if (!mesh.HasDensity())
  {
    throw std::invalid_argument("The mesh holds no density: fit one first.");
  }
  const auto                   regionOf = [&mesh](std::size_t t) { return mesh.region.empty() ? 0 : mesh.region[t]; };
  std::map<int, RegionDensity> regions;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    RegionDensity & entry = regions[regionOf(t)];
    const double    volume = Volume(mesh, t);
    entry.region = regionOf(t);
    ++entry.tetrahedra;
    entry.volume += volume;
    entry.mass += BernsteinIntegral(mesh.degree[t], Row(mesh, t), volume);
  }
  for (auto & [region, entry] : regions)
  {
    entry.mean = entry.volume > 0 ? entry.mass / entry.volume : 0.0;
  }
  // Squares of the difference to the mean: nothing cancels.
  std::vector<double> shifted;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
  {
    RegionDensity & entry = regions[regionOf(t)];
    shifted.assign(Row(mesh, t), Row(mesh, t) + BernsteinCount(mesh.degree[t]));
    for (double & c : shifted)
    {
      c -= entry.mean;
    }
    entry.standardDeviation +=
      BernsteinInnerProduct(mesh.degree[t], shifted.data(), mesh.degree[t], shifted.data(), Volume(mesh, t));
  }
  std::vector<RegionDensity> result;
  for (auto & [region, entry] : regions)
  {
    entry.standardDeviation = entry.volume > 0 ? std::sqrt(std::max(entry.standardDeviation / entry.volume, 0.0)) : 0.0;
    result.push_back(entry);
  }
  return result;
}

DensityComparison
CompareDensity(const MeshArrays &     mesh,
               const VoxelGrid &      grid,
               const VoxelReference & reference,
               const Execution &      execution)
{
  const DensityRaster    raster(mesh, grid);
  std::vector<SliceSums> slices(grid.size[2]);
  execution.For(slices.size(),
                [&](std::size_t k) { slices[k] = CompareSlice(raster, grid, static_cast<int>(k), reference); });
  DensityComparison  error;
  SliceSums          total;
  std::vector<float> values;
  for (const SliceSums & slice : slices)
  {
    total.absolute += slice.absolute;
    total.square += slice.square;
    total.difference += slice.difference;
    error.uncovered += slice.uncovered;
    values.insert(values.end(), slice.reference.begin(), slice.reference.end());
  }
  error.voxels = values.size();
  if (values.empty())
  {
    return error;
  }
  const auto count = static_cast<double>(values.size());
  error.meanAbsolute = total.absolute / count;
  error.rootMeanSquare = std::sqrt(total.square / count);
  error.standardDeviation = std::sqrt(std::max(total.square / count - error.meanAbsolute * error.meanAbsolute, 0.0));
  error.bias = total.difference / count;
  error.range = Percentile(values, 99) - Percentile(values, 1);
  error.meanAbsolutePercent = error.range > 0 ? 100 * error.meanAbsolute / error.range : 0.0;
  return error;
}
} // namespace bone
