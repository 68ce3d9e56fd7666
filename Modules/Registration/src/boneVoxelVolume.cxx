/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVoxelVolume.h"

#include "boneDensityRaster.h"

#include <algorithm>

namespace bone
{
bool
VolumeView::Sample(const Vector3 & x, double & value, Vector3 * gradient) const
{
  const Vector3  index = toIndex * (x - grid.origin);
  std::ptrdiff_t step[3] = { 1, grid.size[0], static_cast<std::ptrdiff_t>(grid.size[0]) * grid.size[1] };
  std::ptrdiff_t offset = 0;
  Vector3        f;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double last = grid.size[axis] - 1.0;
    if (!(index[axis] >= 0.0 && index[axis] <= last))
    {
      return false;
    }
    const int cell = std::min(static_cast<int>(index[axis]), std::max(grid.size[axis] - 2, 0));
    f[axis] = index[axis] - cell;
    offset += cell * step[axis];
    step[axis] = grid.size[axis] > 1 ? step[axis] : 0;
  }
  const float * p = values + offset;
  const auto at = [&](int i, int j, int k) { return static_cast<double>(p[i * step[0] + j * step[1] + k * step[2]]); };
  const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
  double     alongX[2][2];
  for (int k = 0; k < 2; ++k)
  {
    for (int j = 0; j < 2; ++j)
    {
      alongX[k][j] = mix(at(0, j, k), at(1, j, k), f[0]);
    }
  }
  const double low = mix(alongX[0][0], alongX[0][1], f[1]), high = mix(alongX[1][0], alongX[1][1], f[1]);
  value = mix(low, high, f[2]);
  if (gradient != nullptr)
  {
    const auto    slope = [&](int j, int k) { return at(1, j, k) - at(0, j, k); };
    const Vector3 byIndex(mix(mix(slope(0, 0), slope(1, 0), f[1]), mix(slope(0, 1), slope(1, 1), f[1]), f[2]),
                          mix(alongX[0][1] - alongX[0][0], alongX[1][1] - alongX[1][0], f[2]),
                          high - low);
    *gradient = toIndex.transpose() * byIndex;
  }
  return true;
}

VoxelVolume
AverageBlocks(const VolumeView &                    volume,
              double                                spacing,
              const std::function<double(double)> & map,
              const Execution &                     execution)
{
  VoxelVolume        result;
  std::array<int, 3> width;
  Vector3            centre;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double edge = volume.grid.axes.col(axis).norm();
    width[axis] = std::clamp(static_cast<int>(spacing / edge + 0.5), 1, volume.grid.size[axis]);
    result.grid.size[axis] = volume.grid.size[axis] / width[axis];
    result.grid.axes.col(axis) = volume.grid.axes.col(axis) * width[axis];
    centre[axis] = 0.5 * (width[axis] - 1.0);
  }
  result.grid.origin = volume.grid.origin + volume.grid.axes * centre;
  result.values.resize(result.grid.NumberOfVoxels());
  const auto & size = result.grid.size;
  const double share = 1.0 / (static_cast<double>(width[0]) * width[1] * width[2]);
  execution.For(static_cast<std::size_t>(size[2]), [&](std::size_t k) {
    std::vector<double> sums(static_cast<std::size_t>(size[0]) * size[1], 0.0);
    for (int c = 0; c < width[2]; ++c)
    {
      for (int j = 0; j < size[1] * width[1]; ++j)
      {
        const std::size_t row =
          ((k * width[2] + c) * volume.grid.size[1] + static_cast<std::size_t>(j)) * volume.grid.size[0];
        double * sum = &sums[static_cast<std::size_t>(j / width[1]) * size[0]];
        for (int i = 0; i < size[0]; ++i)
        {
          for (int a = 0; a < width[0]; ++a)
          {
            sum[i] += map(volume.values[row + static_cast<std::size_t>(i * width[0] + a)]);
          }
        }
      }
    }
    std::transform(sums.begin(),
                   sums.end(),
                   result.values.begin() + static_cast<std::ptrdiff_t>(k * sums.size()),
                   [&](double sum) { return static_cast<float>(sum * share); });
  });
  return result;
}

double
BoneLikeness(double density)
{
  constexpr double none = 60.0, full = 460.0; // HU
  return std::clamp((density - none) / (full - none), 0.0, 1.0);
}

VoxelVolume
RasterizeMesh(const MeshArrays & mesh, double spacing, double margin, double softTissue, const Execution & execution)
{
  Vector3 lower = mesh.points.front(), upper = lower;
  for (const Vector3 & x : mesh.points)
  {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  VoxelVolume result;
  result.grid.origin = lower - Vector3::Constant(margin);
  result.grid.axes = spacing * Eigen::Matrix3d::Identity();
  for (int axis = 0; axis < 3; ++axis)
  {
    result.grid.size[axis] = static_cast<int>((upper[axis] - lower[axis] + 2.0 * margin) / spacing) + 2;
  }
  result.values.resize(result.grid.NumberOfVoxels());
  const DensityRaster raster(mesh, result.grid);
  const std::size_t   slice = static_cast<std::size_t>(result.grid.size[0]) * result.grid.size[1];
  execution.For(static_cast<std::size_t>(result.grid.size[2]), [&](std::size_t k) {
    std::vector<double> values(slice);
    raster.FillSlice(static_cast<int>(k), softTissue, values.data());
    std::transform(values.begin(),
                   values.end(),
                   result.values.begin() + static_cast<std::ptrdiff_t>(k * slice),
                   [](double v) { return static_cast<float>(v); });
  });
  return result;
}
} // namespace bone
