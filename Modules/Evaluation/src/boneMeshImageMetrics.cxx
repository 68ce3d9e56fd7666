/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshImageMetrics.h"

#include "boneDensityRaster.h"
#include "boneExecution.h"
#include "boneOrthonormalBasis.h"
#include "boneTriangleTree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bone
{
namespace
{
/** Value below which a share of the values lies; reorders them. */
double
Percentile(std::vector<double> & values, double share)
{
  if (values.empty())
  {
    return 0.0;
  }
  const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

SurfaceDistance
Summarize(std::vector<double> & distances)
{
  SurfaceDistance summary;
  for (const double d : distances)
  {
    summary.mean += d / static_cast<double>(distances.size());
    summary.maximum = std::max(summary.maximum, d);
  }
  summary.percentile95 = Percentile(distances, 0.95);
  return summary;
}

/** Points on a triangle about `step` apart, its corners among them. */
void
SampleTriangle(const TriangleTree::Triangle & t, double step, std::vector<Vector3> & points)
{
  const double longest = std::max({ (t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm() });
  const int    n = std::clamp(static_cast<int>(std::ceil(longest / step)), 1, 24);
  for (int i = 0; i <= n; ++i)
  {
    for (int j = 0; j <= n - i; ++j)
    {
      points.push_back((t[0] * i + t[1] * j + t[2] * (n - i - j)) / n);
    }
  }
}

/** The mesh's density at the voxels of each slice, NaN outside the mesh: on all threads, a slice at a time as a whole
 * image of them would take much memory. `work` is told slice, number of its first voxel, and densities. */
template <typename TWork>
void
ForSlices(const MeshArrays & mesh, const LabelImage * grid, TWork && work)
{
  const VoxelGrid     voxels = MakeVoxelGrid(*grid, grid->GetLargestPossibleRegion());
  const DensityRaster raster(mesh, voxels);
  const auto          size = static_cast<std::size_t>(voxels.size[0]) * static_cast<std::size_t>(voxels.size[1]);
  Execution().For(static_cast<std::size_t>(voxels.size[2]), [&](std::size_t z) {
    std::vector<double> values(size);
    raster.FillSlice(static_cast<int>(z), std::numeric_limits<double>::quiet_NaN(), values.data());
    work(z, z * size, values);
  });
}

SurfaceDistance
DistanceToTree(const std::vector<Vector3> & points, const TriangleTree & tree)
{
  constexpr std::size_t chunk = 4096; // of points that follow each other, which are near each other
  std::vector<double>   distances(points.size());
  Execution().For((points.size() + chunk - 1) / chunk, [&](std::size_t c) {
    int nearest = -1;
    for (std::size_t i = c * chunk; i < std::min(points.size(), (c + 1) * chunk); ++i)
    {
      distances[i] = std::sqrt(tree.FindSquaredDistance(points[i], nearest));
    }
  });
  return Summarize(distances);
}

SurfaceDistance
DistanceToFaces(const std::vector<Vector3> & points, const VoxelFaces & faces)
{
  std::vector<double> distances(points.size());
  Execution().For(
    points.size(), [&](std::size_t i) { distances[i] = faces.Distance(points[i]); }, 1024);
  return Summarize(distances);
}
} // namespace

double
DiceOverlap(const MeshArrays & mesh, const LabelImage * mask)
{
  const auto               region = mask->GetLargestPossibleRegion();
  std::vector<std::size_t> both(region.GetSize(2), 0), sum(region.GetSize(2), 0);
  const short * const      l = mask->GetBufferPointer();
  ForSlices(mesh, mask, [&](std::size_t z, std::size_t first, const std::vector<double> & values) {
    for (std::size_t k = 0; k < values.size(); ++k)
    {
      const bool inMesh = !std::isnan(values[k]);
      const bool inMask = l[first + k] != 0;
      both[z] += inMesh && inMask ? 1 : 0;
      sum[z] += (inMesh ? 1 : 0) + (inMask ? 1 : 0);
    }
  });
  const auto all = std::accumulate(sum.begin(), sum.end(), std::size_t{ 0 });
  const auto common = std::accumulate(both.begin(), both.end(), std::size_t{ 0 });
  return all == 0 ? 0.0 : 2.0 * static_cast<double>(common) / static_cast<double>(all);
}

LabelImage::Pointer
MaskOfMesh(const MeshArrays & mesh, const itk::ImageBase<3> * grid)
{
  auto mask = LabelImage::New();
  mask->CopyInformation(grid);
  mask->SetRegions(grid->GetLargestPossibleRegion());
  mask->Allocate();
  short * const l = mask->GetBufferPointer();
  ForSlices(mesh, mask, [&](std::size_t, std::size_t first, const std::vector<double> & values) {
    std::transform(
      values.begin(), values.end(), l + first, [](double value) { return static_cast<short>(!std::isnan(value)); });
  });
  return mask;
}

SurfaceDistanceMeter::SurfaceDistanceMeter(const LabelImage * mask)
  : m_Faces(mask)
  , m_Centres(m_Faces.GetCentres())
{}

SurfaceDistances
SurfaceDistanceMeter::Measure(const MeshArrays & mesh) const
{
  std::vector<TriangleTree::Triangle> boundary;
  std::vector<Vector3>                samples;
  for (const auto & face : BoundaryFaces(mesh))
  {
    boundary.push_back({ { mesh.points[face[0]], mesh.points[face[1]], mesh.points[face[2]] } });
    SampleTriangle(boundary.back(), 0.5, samples);
  }
  SurfaceDistances distances;
  distances.meshToMask = DistanceToFaces(samples, m_Faces);
  distances.maskToMesh = DistanceToTree(m_Centres, TriangleTree(std::move(boundary)));
  return distances;
}

DensityComparison
CompareWithImage(const MeshArrays & mesh, const CTImage * ct, const LabelImage * mask)
{
  const float * density = ct->GetBufferPointer();
  const short * inside = mask->GetBufferPointer();
  return CompareDensity(
    mesh, MakeVoxelGrid(*ct, ct->GetBufferedRegion()), [density, inside](std::size_t offset, double & value) {
      value = density[offset];
      return inside[offset] != 0;
    });
}

std::vector<double>
LowerDegreeErrors(const MeshArrays & mesh, const CTImage * ct, const LabelImage * mask)
{
  std::vector<double> errors;
  MeshArrays          cut = mesh;
  const auto          from = static_cast<std::size_t>(BernsteinCount(mesh.maximumDegree));
  for (int degree = 0; degree < mesh.maximumDegree; ++degree)
  {
    const auto count = static_cast<std::size_t>(BernsteinCount(degree));
    cut.maximumDegree = degree;
    cut.coefficients.assign(count * mesh.tetrahedra.size(), 0.0);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    {
      cut.degree[t] = std::min(degree, mesh.degree[t]);
      BernsteinReduce(mesh.degree[t], &mesh.coefficients[t * from], cut.degree[t], &cut.coefficients[t * count]);
    }
    errors.push_back(CompareWithImage(cut, ct, mask).meanAbsolutePercent);
  }
  return errors;
}

std::array<double, 2>
PercentileRange(const CTImage * ct, const LabelImage * mask)
{
  const std::size_t   count = ct->GetLargestPossibleRegion().GetNumberOfPixels();
  const short * const inside = mask->GetBufferPointer();
  std::vector<double> values;
  values.reserve(count - static_cast<std::size_t>(std::count(inside, inside + count, short{ 0 })));
  for (std::size_t k = 0; k < count; ++k)
  {
    if (inside[k] != 0)
    {
      values.push_back(ct->GetBufferPointer()[k]);
    }
  }
  return { { Percentile(values, 0.01), Percentile(values, 0.99) } };
}

double
RadiographDifferencePercent(const CTImage * reference, const CTImage * radiograph)
{
  const std::size_t   count = reference->GetLargestPossibleRegion().GetNumberOfPixels();
  const float *       a = reference->GetBufferPointer();
  const float *       b = radiograph->GetBufferPointer();
  std::vector<double> values;
  double              sum = 0.0;
  for (std::size_t k = 0; k < count; ++k)
  {
    if (a[k] != 0.0F)
    {
      values.push_back(a[k]);
      sum += std::abs(b[k] - a[k]);
    }
  }
  const double range = Percentile(values, 0.99) - Percentile(values, 0.01);
  return range > 0.0 ? 100.0 * sum / static_cast<double>(values.size()) / range : 0.0;
}
} // namespace bone
