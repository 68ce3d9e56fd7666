/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneReferenceRegion_h
#define boneReferenceRegion_h

#include "boneExecution.h"
#include "boneTriangleTree.h"
#include "boneVoxelGrid.h"

#include <algorithm>
#include <cmath>

namespace bone
{
/** A rod or a ball in an image: all that lies within `radius` of the segment from `from` to `to` (mm; rounded ends). */
struct ReferenceRegion
{
  Vector3 from{ Vector3::Zero() };
  Vector3 to{ Vector3::Zero() };
  double  radius{ 0.0 };

  bool
  operator==(const ReferenceRegion & other) const
  {
    return from == other.from && to == other.to && radius == other.radius;
  }
};

/** The voxels of a region. */
struct ReferenceStatistics
{
  std::size_t voxels{ 0 };
  double      mean{ 0.0 };
  double      standardDeviation{ 0.0 };
};

/** Mean and deviation of an image's voxels whose centres lie in the region; 0 voxels where there are none. Keep the
 * radius a voxel or two below the rod's own, so that its border does not count. */
template <typename TImage>
ReferenceStatistics
MeasureReference(const TImage & image, const ReferenceRegion & region, const Execution & execution = Execution())
{
  const VoxelGrid       grid = MakeVoxelGrid(image, image.GetBufferedRegion());
  const Eigen::Matrix3d toIndex = grid.axes.inverse();
  const auto *          buffer = image.GetBufferPointer();
  const Vector3         a = toIndex * (region.from - grid.origin), b = toIndex * (region.to - grid.origin);
  std::array<int, 3>    first, last;
  for (int axis = 0; axis < 3; ++axis)
  {
    // A ball's extent along an index axis is its radius times the length of that row of the inverse.
    const double reach = region.radius * toIndex.row(axis).norm();
    const double end = grid.size[axis] - 1.0;
    first[axis] = static_cast<int>(std::ceil(std::clamp(std::min(a[axis], b[axis]) - reach, 0.0, end + 1)));
    last[axis] = static_cast<int>(std::floor(std::clamp(std::max(a[axis], b[axis]) + reach, -1.0, end)));
  }
  ReferenceStatistics statistics;
  double              squares = 0;
  for (int k = first[2]; k <= last[2]; ++k)
  {
    execution.ThrowIfAborted();
    for (int j = first[1]; j <= last[1]; ++j)
    {
      for (int i = first[0]; i <= last[0]; ++i)
      {
        const Vector3 x = grid.Centre(i, j, k);
        if ((x - ClosestPointOnSegment(x, region.from, region.to)).norm() > region.radius)
        {
          continue;
        }
        const std::size_t at = (static_cast<std::size_t>(k) * grid.size[1] + j) * grid.size[0] + i;
        const double      rest = static_cast<double>(buffer[at]) - statistics.mean; // Welford
        ++statistics.voxels;
        statistics.mean += rest / static_cast<double>(statistics.voxels);
        squares += rest * (static_cast<double>(buffer[at]) - statistics.mean);
      }
    }
  }
  statistics.standardDeviation =
    statistics.voxels > 0 ? std::sqrt(squares / static_cast<double>(statistics.voxels)) : 0.0;
  return statistics;
}

/** The same for the voxels of a label. \pre The label map has the image's buffered region. */
template <typename TImage, typename TLabels>
ReferenceStatistics
MeasureReference(const TImage & image, const TLabels & labels, int label, const Execution & execution = Execution())
{
  ReferenceStatistics statistics;
  double              squares = 0;
  const std::size_t   count = image.GetBufferedRegion().GetNumberOfPixels();
  for (std::size_t v = 0; v < count; ++v)
  {
    if (v % (std::size_t{ 1 } << 20) == 0)
    {
      execution.Report(static_cast<double>(v) / static_cast<double>(count));
    }
    if (labels.GetBufferPointer()[v] == label)
    {
      const double value = image.GetBufferPointer()[v], rest = value - statistics.mean; // Welford
      ++statistics.voxels;
      statistics.mean += rest / static_cast<double>(statistics.voxels);
      squares += rest * (value - statistics.mean);
    }
  }
  statistics.standardDeviation =
    statistics.voxels > 0 ? std::sqrt(squares / static_cast<double>(statistics.voxels)) : 0.0;
  return statistics;
}
} // namespace bone

#endif
