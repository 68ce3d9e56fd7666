/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceBand.h"

#include <cmath>
#include <stdexcept>

namespace bone
{
namespace
{
constexpr int    BlockSize = 4;   // voxels that are passed over together where they are far from the surface
constexpr double StepOfWay = 0.5; // mm, of the way through the bone

/** A box of voxels: first and behind the last along each axis. */
struct Box
{
  std::array<int, 3> begin;
  std::array<int, 3> end;
};

/** The voxels of the grid around the points, with a margin in mm. */
Box
BoxAround(const std::vector<Vector3> & points, const VoxelGrid & grid, double margin)
{
  const Eigen::Matrix3d toIndex = grid.axes.inverse();
  Box                   box{ { 0, 0, 0 }, { 0, 0, 0 } };
  for (int axis = 0; axis < 3; ++axis)
  {
    double       lower = std::numeric_limits<double>::infinity(), upper = -lower;
    const double reach = margin * toIndex.row(axis).norm();
    for (const Vector3 & p : points)
    {
      const double x = toIndex.row(axis).dot(p - grid.origin);
      lower = std::min(lower, x - reach);
      upper = std::max(upper, x + reach);
    }
    const double size = grid.size[axis];
    box.begin[axis] = static_cast<int>(std::clamp(std::ceil(lower), 0.0, size));
    box.end[axis] = static_cast<int>(std::clamp(std::floor(upper) + 1.0, 0.0, size));
  }
  return box;
}

std::vector<Box>
BlocksOf(const Box & box)
{
  std::vector<Box> blocks;
  for (int k = box.begin[2]; k < box.end[2]; k += BlockSize)
  {
    for (int j = box.begin[1]; j < box.end[1]; j += BlockSize)
    {
      for (int i = box.begin[0]; i < box.end[0]; i += BlockSize)
      {
        blocks.push_back({ { i, j, k },
                           { std::min(i + BlockSize, box.end[0]),
                             std::min(j + BlockSize, box.end[1]),
                             std::min(k + BlockSize, box.end[2]) } });
      }
    }
  }
  return blocks;
}

/** Empty where all is cut. */
TriangleTree
WithoutCuts(const TriangleSurface & surface, const std::vector<bool> & cut)
{
  std::vector<TriangleTree::Triangle> triangles;
  for (std::size_t t = 0; t < cut.size(); ++t)
  {
    if (!cut[t])
    {
      const auto & v = surface.triangles[t];
      triangles.push_back({ { surface.points[v[0]], surface.points[v[1]], surface.points[v[2]] } });
    }
  }
  return TriangleTree(std::move(triangles));
}
} // namespace

SurfaceBand::SurfaceBand(const TriangleSurface &   surface,
                         const std::vector<bool> & cut,
                         const CTVoxels &          ct,
                         double                    outside,
                         double                    inside,
                         double                    radius,
                         const Execution &         execution)
  : m_CT(ct)
  , m_Whole(surface.points, { surface.triangles.begin(), surface.triangles.end() })
  , m_Inside(inside)
  , m_Radius(radius)
{
  const TriangleTree              sides = WithoutCuts(surface, cut);
  const auto                      blocks = BlocksOf(BoxAround(surface.points, ct.grid, outside));
  std::vector<std::vector<Voxel>> found(blocks.size());
  const double                    reach = 0.5 * BlockSize * ct.grid.axes.colwise().norm().sum();
  const auto                      visit = [&](std::size_t b) {
    const Box &   block = blocks[b];
    const Vector3 middle = 0.5 * (ct.grid.Centre(block.begin[0], block.begin[1], block.begin[2]) +
                                  ct.grid.Centre(block.end[0] - 1, block.end[1] - 1, block.end[2] - 1));
    const double  farthest = reach + std::max(outside, inside);
    if (!sides.IsWithin(middle, farthest * farthest))
    {
      return;
    }
    for (int k = block.begin[2]; k < block.end[2]; ++k)
    {
      for (int j = block.begin[1]; j < block.end[1]; ++j)
      {
        for (int i = block.begin[0]; i < block.end[0]; ++i)
        {
          const Vector3 x = ct.grid.Centre(i, j, k);
          const auto    nearest = m_Whole.FindNearest(x);
          const bool    within = nearest.distance < 0.0, atCut = cut[static_cast<std::size_t>(nearest.triangle)];
          if (std::abs(nearest.distance) > (within ? inside : outside) || (atCut && !within))
          {
            continue;
          }
          const Vector3 foot = atCut ? sides.FindNearest(x).point : nearest.point;
          const double  distance = (x - foot).norm();
          if (distance <= (within ? inside : outside))
          {
            const std::size_t at = (static_cast<std::size_t>(k) * ct.grid.size[1] + j) * ct.grid.size[0] + i;
            found[b].push_back({ foot, { within ? distance : -distance, ct.value(at) } });
          }
        }
      }
    }
  };
  execution.For(blocks.size(), visit, 16);
  for (const auto & voxels : found)
  {
    for (const Voxel & voxel : voxels)
    {
      if (!std::isfinite(voxel.sample.value))
      {
        throw std::invalid_argument("A voxel near the surface is not finite.");
      }
      m_Cells[this->CellOf(voxel.foot, 0, 0, 0)].push_back(static_cast<int>(m_Voxels.size()));
      m_Voxels.push_back(voxel);
    }
  }
  if (m_Voxels.empty())
  {
    throw std::invalid_argument("The mesh lies outside the image.");
  }
}

std::uint64_t
SurfaceBand::CellOf(const Vector3 & x, int i, int j, int k) const
{
  constexpr std::int64_t half = std::int64_t(1) << 20;
  const auto             part = [&](double at, int shift) {
    return static_cast<std::uint64_t>((static_cast<std::int64_t>(std::floor(at / m_Radius)) + shift + half) &
                                      (2 * half - 1));
  };
  return (part(x[0], i) << 42) | (part(x[1], j) << 21) | part(x[2], k);
}

void
SurfaceBand::CollectFeet(const Vector3 & x, std::vector<CorticalSample> & samples) const
{
  for (int i = -1; i <= 1; ++i)
  {
    for (int j = -1; j <= 1; ++j)
    {
      for (int k = -1; k <= 1; ++k)
      {
        const auto cell = m_Cells.find(this->CellOf(x, i, j, k));
        if (cell == m_Cells.end())
        {
          continue;
        }
        for (const int voxel : cell->second)
        {
          if ((m_Voxels[static_cast<std::size_t>(voxel)].foot - x).squaredNorm() <= m_Radius * m_Radius)
          {
            samples.push_back(m_Voxels[static_cast<std::size_t>(voxel)].sample);
          }
        }
      }
    }
  }
}
void
SurfaceBand::CollectAlong(const Vector3 &               x,
                          const Vector3 &               inward,
                          double                        from,
                          double                        to,
                          std::vector<CorticalSample> & samples) const
{
  const VoxelGrid & grid = m_CT.grid;
  const Box         box = BoxAround({ x + from * inward, x + to * inward }, grid, m_Radius);
  for (int k = box.begin[2]; k < box.end[2]; ++k)
  {
    for (int j = box.begin[1]; j < box.end[1]; ++j)
    {
      for (int i = box.begin[0]; i < box.end[0]; ++i)
      {
        const Vector3 offset = grid.Centre(i, j, k) - x;
        const double  depth = offset.dot(inward);
        if (depth > from && depth <= to && (offset - depth * inward).squaredNorm() <= m_Radius * m_Radius)
        {
          samples.push_back({ depth, m_CT.value((static_cast<std::size_t>(k) * grid.size[1] + j) * grid.size[0] + i) });
        }
      }
    }
  }
}

double
SurfaceBand::HalfWay(const Vector3 & x, const Vector3 & inward) const
{
  double way = StepOfWay;
  while (way < 2.0 * m_Inside && m_Whole.FindNearest(x + way * inward).distance < 0.0)
  {
    way += StepOfWay;
  }
  return std::min(0.5 * way, m_Inside);
}

std::vector<CorticalSample>
SurfaceBand::Collect(const Vector3 & x, const Vector3 & inward) const
{
  std::vector<CorticalSample> samples;
  this->CollectFeet(x, samples);
  double deepest = -1.0;
  for (const CorticalSample & sample : samples)
  {
    deepest = std::max(deepest, sample.depth);
  }
  if (deepest > 0.0 && deepest + StepOfWay < m_Inside)
  {
    const double half = this->HalfWay(x, inward);
    if (half > deepest)
    {
      this->CollectAlong(x, inward, deepest, half, samples);
    }
  }
  return samples;
}
} // namespace bone
