/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneVoxelRadiograph.h"

#include "boneRayFrame.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
/** One index axis of the grid as a ray that follows another axis sees it. */
struct Axis
{
  int            size;
  std::ptrdiff_t stride;

  /** Lower neighbour of a position, the offset to the upper one (0 at the border), and the upper one's weight. */
  void
  Locate(float x, std::ptrdiff_t & offset, std::ptrdiff_t & toUpper, float & weight) const
  {
    const float inside = std::min(std::max(x, 0.0f), static_cast<float>(size - 1));
    const int   lower = std::min(static_cast<int>(inside), std::max(0, size - 2));
    offset = lower * stride;
    toUpper = size > 1 ? stride : 0;
    weight = inside - static_cast<float>(lower);
  }
};

class VoxelProjector
{
public:
  VoxelProjector(const VoxelVolume & grid, const XRayGeometry::View & view)
    : m_Values(grid.values.data())
    , m_Frame(view)
    , m_ToIndex(grid.axes.inverse())
    , m_GridOrigin(grid.origin)
    , m_Axes{ { { grid.size[0], 1 },
                { grid.size[1], grid.size[0] },
                { grid.size[2], static_cast<std::ptrdiff_t>(grid.size[0]) * grid.size[1] } } }
  {}

  double
  Integrate(int column, int row) const;

private:
  float
  Bilinear(const float * plane, const Axis & u, const Axis & v, float x, float y) const
  {
    std::ptrdiff_t i, j, di, dj;
    float          wx, wy;
    u.Locate(x, i, di, wx);
    v.Locate(y, j, dj, wy);
    const float * p = plane + i + j;
    const float   low = p[0] + wx * (p[di] - p[0]), high = p[dj] + wx * (p[dj + di] - p[dj]);
    return low + wy * (high - low);
  }
  double
  Sum(int main, const Vector3 & from, const Vector3 & to) const;

  const float *       m_Values;
  RayFrame            m_Frame;
  Eigen::Matrix3d     m_ToIndex;
  Vector3             m_GridOrigin;
  std::array<Axis, 3> m_Axes;
};

/** Integral of the image over the ray's part from `from` to `to` (indices), per step of 1 along the main axis. */
double
VoxelProjector::Sum(int main, const Vector3 & from, const Vector3 & to) const
{
  const Axis &  axis = m_Axes[main];
  const int     a = (main + 1) % 3, b = (main + 2) % 3;
  const bool    forward = from[main] <= to[main];
  const double  low = forward ? from[main] : to[main], high = forward ? to[main] : from[main];
  const Vector3 start = forward ? from : to;
  const Vector3 slope = (to - from) / (to[main] - from[main]);
  const int     last = axis.size - 1;
  const int     firstPlane = std::clamp(static_cast<int>(std::floor(low + 0.5)), 0, last);
  const int     lastPlane = std::clamp(static_cast<int>(std::floor(high + 0.5)), 0, last);

  // A piece that is cut short is sampled at its middle, between two planes.
  const auto cutPiece = [&](int plane) {
    const double   begin = std::max(low, plane - 0.5), end = std::min(high, plane + 0.5), x = 0.5 * (begin + end);
    std::ptrdiff_t offset, toUpper;
    float          weight;
    axis.Locate(static_cast<float>(x), offset, toUpper, weight);
    const auto  u = static_cast<float>(start[a] + (x - low) * slope[a]);
    const auto  v = static_cast<float>(start[b] + (x - low) * slope[b]);
    const float lower = Bilinear(m_Values + offset, m_Axes[a], m_Axes[b], u, v);
    const float upper = Bilinear(m_Values + offset + toUpper, m_Axes[a], m_Axes[b], u, v);
    return std::max(0.0, end - begin) * (lower + weight * (upper - lower));
  };
  double sum = cutPiece(firstPlane);
  if (lastPlane > firstPlane)
  {
    sum += cutPiece(lastPlane);
  }
  const auto stepA = static_cast<float>(slope[a]), stepB = static_cast<float>(slope[b]);
  const auto u0 = static_cast<float>(start[a] + (firstPlane - low) * slope[a]);
  const auto v0 = static_cast<float>(start[b] + (firstPlane - low) * slope[b]);
  float      inner = 0.0f;
  for (int plane = firstPlane + 1; plane < lastPlane; ++plane)
  {
    const auto step = static_cast<float>(plane - firstPlane);
    inner += Bilinear(m_Values + plane * axis.stride, m_Axes[a], m_Axes[b], u0 + step * stepA, v0 + step * stepB);
  }
  return sum + inner;
}

double
VoxelProjector::Integrate(int column, int row) const
{
  const Vector3 origin = m_ToIndex * (m_Frame.Origin(column, row) - m_GridOrigin);
  const Vector3 direction = m_ToIndex * m_Frame.Direction(column, row);
  double        first = m_Frame.IsParallel() ? -std::numeric_limits<double>::infinity() : 0.0;
  double        last = m_Frame.IsParallel() ? 0.0 : 1.0;
  for (int k = 0; k < 3; ++k)
  {
    const double lower = -0.5 - origin[k], upper = m_Axes[k].size - 0.5 - origin[k];
    if (direction[k] == 0)
    {
      last = lower <= 0 && upper >= 0 ? last : -std::numeric_limits<double>::infinity();
      continue;
    }
    first = std::max(first, std::min(lower / direction[k], upper / direction[k]));
    last = std::min(last, std::max(lower / direction[k], upper / direction[k]));
  }
  if (!(first < last))
  {
    return 0.0;
  }
  int          main = 0;
  const double along = direction.cwiseAbs().maxCoeff(&main);
  return Sum(main, origin + first * direction, origin + last * direction) * m_Frame.StepLength(column, row) / along;
}
} // namespace

void
ProjectVoxels(const VoxelVolume & grid, const XRayGeometry::View & view, const Execution & execution, float * image)
{
  const VoxelProjector projector(grid, view);
  execution.For(view.size[1], [&](std::size_t row) {
    for (int column = 0; column < view.size[0]; ++column)
    {
      image[row * view.size[0] + column] = static_cast<float>(projector.Integrate(column, static_cast<int>(row)));
    }
  });
}
} // namespace bone
