/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneScatter.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
/** Pixels of the grid in a standard deviation of the Gaussian, at least: coarser ones follow it badly. */
constexpr double PixelsInWidth = 6.0;
constexpr double SmallestChange = 1e-6;
constexpr int    MostIterations = 200;

/** One axis of an image that is averaged in blocks, blurred, and interpolated back. */
struct BlurAxis
{
  BlurAxis(int count, double width)
    : size(count)
    , block(std::max(1, static_cast<int>(width / PixelsInWidth)))
    , blocks((count + block - 1) / block)
  {
    // Averaging and linear interpolation blur too.
    const double b = block;
    const double already = block > 1 ? (b * b - 1) / 12 + b * b / 6 : 0.0;
    const double sigma = std::sqrt(std::max(0.0, width * width - already)) / b;
    const int    reach = static_cast<int>(std::ceil(4 * sigma));
    double       sum = 0.0;
    for (int k = -reach; k <= reach; ++k)
    {
      kernel.push_back(sigma > 0 ? std::exp(-0.5 * k * k / (sigma * sigma)) : 1.0);
      sum += kernel.back();
    }
    for (double & weight : kernel)
    {
      weight /= sum;
    }
    for (int pixel = 0; pixel < size; ++pixel)
    {
      const double at = std::clamp((pixel - 0.5 * (block - 1)) / block, 0.0, blocks - 1.0);
      before.push_back(std::min(static_cast<int>(at), std::max(0, blocks - 2)));
      share.push_back(at - before.back());
    }
  }

  /** Blurs a line of blocks, which goes on at its ends as it is there. */
  std::vector<double>
  Blur(const std::vector<double> & line) const
  {
    const int           reach = static_cast<int>(kernel.size() / 2);
    std::vector<double> blurred(line.size(), 0.0);
    for (int i = 0; i < blocks; ++i)
    {
      for (int k = -reach; k <= reach; ++k)
      {
        blurred[i] += kernel[k + reach] * line[std::clamp(i + k, 0, blocks - 1)];
      }
    }
    return blurred;
  }

  int                 size, block, blocks;
  std::vector<double> kernel;
  std::vector<int>    before; ///< of each pixel, the block before it
  std::vector<double> share;  ///< and the share of the block after that
};
} // namespace

std::vector<double>
BlurWidely(const std::vector<double> & values, const DetectorGrid & grid, double width, const Execution & execution)
{
  const BlurAxis      x(grid.size[0], width / grid.spacing.x()), y(grid.size[1], width / grid.spacing.y());
  const Execution     silent = execution.Silent();
  std::vector<double> coarse(static_cast<std::size_t>(x.blocks) * y.blocks);
  silent.For(y.blocks, [&](std::size_t j) {
    std::vector<double> line(x.blocks, 0.0);
    const int           first = static_cast<int>(j) * y.block, last = std::min(y.size, first + y.block);
    for (int i = 0; i < x.blocks; ++i)
    {
      const int end = std::min(x.size, (i + 1) * x.block);
      for (int r = first; r < last; ++r)
      {
        for (int c = i * x.block; c < end; ++c)
        {
          line[i] += values[static_cast<std::size_t>(r) * x.size + c];
        }
      }
      line[i] /= (last - first) * (end - i * x.block);
    }
    const auto blurred = x.Blur(line);
    std::copy(blurred.begin(), blurred.end(), coarse.begin() + static_cast<std::ptrdiff_t>(j * x.blocks));
  });
  silent.For(x.blocks, [&](std::size_t i) {
    std::vector<double> line(y.blocks);
    for (int j = 0; j < y.blocks; ++j)
    {
      line[j] = coarse[static_cast<std::size_t>(j) * x.blocks + i];
    }
    line = y.Blur(line);
    for (int j = 0; j < y.blocks; ++j)
    {
      coarse[static_cast<std::size_t>(j) * x.blocks + i] = line[j];
    }
  });
  std::vector<double> result(values.size());
  silent.For(
    y.size,
    [&](std::size_t r) {
      const int      next = std::min(y.before[r] + 1, y.blocks - 1), step = x.blocks > 1 ? 1 : 0;
      const double * upper = coarse.data() + static_cast<std::size_t>(y.before[r]) * x.blocks;
      const double * lower = coarse.data() + static_cast<std::size_t>(next) * x.blocks;
      for (int c = 0; c < x.size; ++c)
      {
        const int    left = x.before[c];
        const double above = upper[left] + x.share[c] * (upper[left + step] - upper[left]);
        const double below = lower[left] + x.share[c] * (lower[left + step] - lower[left]);
        result[r * x.size + c] = above + y.share[r] * (below - above);
      }
    },
    16);
  return result;
}

std::vector<double>
ComputeScatter(const std::vector<double> & primary,
               const DetectorGrid &        grid,
               const ScatterModel &        model,
               const Execution &           execution)
{
  std::vector<double> source(primary.size());
  std::transform(primary.begin(), primary.end(), source.begin(), [&model](double p) {
    const double attenuated = std::max(0.0, 1 - p / model.open);
    return model.ratio * p * attenuated * attenuated;
  });
  return BlurWidely(source, grid, model.width, execution);
}

ScatterSolution
SubtractScatter(const std::vector<double> & total,
                const DetectorGrid &        grid,
                const ScatterModel &        model,
                double                      leastShare,
                const Execution &           execution)
{
  ScatterSolution solution;
  solution.primary = total;
  if (!(model.ratio > 0))
  {
    return solution;
  }
  // Of an error of S, a step leaves 1 - relaxation (1 + ratio g), where g, from 0 to about 1, is what the blur leaves
  // of it.
  const double        relaxation = 2 / (2 + model.ratio);
  std::vector<double> scatter(total.size(), 0.0);
  double              largest = 0.0;
  do
  {
    execution.ThrowIfAborted();
    const auto made = ComputeScatter(solution.primary, grid, model, execution);
    double     change = 0.0;
    for (std::size_t i = 0; i < scatter.size(); ++i)
    {
      const double step = relaxation * (made[i] - scatter[i]);
      scatter[i] += step;
      change = std::max(change, std::abs(step));
      largest = std::max(largest, scatter[i]);
      solution.primary[i] = std::max(leastShare * total[i], total[i] - scatter[i]);
    }
    solution.change = largest > 0 ? change / largest : 0.0;
    ++solution.iterations;
  } while (solution.change > SmallestChange && solution.iterations < MostIterations);
  return solution;
}
} // namespace bone
