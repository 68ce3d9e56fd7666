/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePhantomSampler.h"

#include "bonePhantomShapes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bone
{
namespace
{
/** Standard deviations (mm) below this count as none. */
constexpr double NoSpread = 1e-6;
/** Edge of the blocks that are classified as a whole, mm. */
constexpr double BlockEdge = 2.0;

/** The part of a standard deviation that the closed form takes. */
double
AnalyticPart(double sigma)
{
  if (sigma <= PhantomSampler::AnalyticSigma)
  {
    return sigma;
  }
  return std::min(sigma * M_SQRT1_2, std::clamp(0.5 * sigma, 0.4, PhantomSampler::LargestAnalyticSigma));
}

long
FloorDivide(long a, long b)
{
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}
} // namespace

/** What blocks of a grid are made of: the number of one region, or Mixed where a surface is within `reach`. The blocks
 * are aligned to index 0, so that they do not depend on the box they are made for. */
class PhantomSampler::Neighbourhoods
{
public:
  static constexpr signed char Mixed = -1;

  Neighbourhoods(const PhantomModel & model, const PhantomGrid & grid, double reach, const PhantomBlock & box)
    : m_Model(model)
    , m_Grid(grid)
    , m_Reach(reach)
  {
    std::array<long, 3> last;
    for (int a = 0; a < 3; ++a)
    {
      m_Edge[a] = std::max(1L, std::lround(BlockEdge / grid.spacing[a]));
      m_First[a] = FloorDivide(box.start[a], m_Edge[a]);
      last[a] = FloorDivide(box.start[a] + static_cast<long>(box.size[a]) - 1, m_Edge[a]);
      m_Size[a] = last[a] - m_First[a] + 1;
    }
    m_Content.resize(m_Size[0] * m_Size[1] * m_Size[2]);
    const auto begin = [&](int a) { return FloorDivide(m_First[a], Coarsest) * Coarsest; };
    for (long k = begin(2); k <= last[2]; k += Coarsest)
    {
      for (long j = begin(1); j <= last[1]; j += Coarsest)
      {
        for (long i = begin(0); i <= last[0]; i += Coarsest)
        {
          this->Fill({ { i, j, k } }, Coarsest);
        }
      }
    }
  }

  signed char
  operator()(long i, long j, long k) const
  {
    const long x = FloorDivide(i, m_Edge[0]) - m_First[0];
    const long y = FloorDivide(j, m_Edge[1]) - m_First[1];
    const long z = FloorDivide(k, m_Edge[2]) - m_First[2];
    return m_Content[(z * m_Size[1] + y) * m_Size[0] + x];
  }

  /** One past the last column of the block that column i lies in. */
  long
  GetColumnEnd(long i) const
  {
    return (FloorDivide(i, m_Edge[0]) + 1) * m_Edge[0];
  }

  /** The region that the ball of the radius about a point with these levels lies in, or Mixed. */
  static signed char
  Classify(const PhantomModel & model, const PhantomModel::Levels & levels, double radius)
  {
    if (levels[PhantomModel::Periosteal] > radius * model.GetLipschitzBound(PhantomModel::Periosteal))
    {
      return Region::Outside;
    }
    for (int s = 0; s < model.GetNumberOfSurfaces(); ++s)
    {
      if (std::abs(levels[s]) <= radius * model.GetLipschitzBound(s))
      {
        return Mixed;
      }
    }
    return static_cast<signed char>(PhantomModel::RegionOf(levels));
  }

private:
  /** Blocks along each edge of the cubes that the search starts from. */
  static constexpr long Coarsest = 16;

  /** Classifies the cube of width^3 blocks from `block` on, by halves where it is mixed. */
  void
  Fill(const std::array<long, 3> & block, long width)
  {
    Vector3 centre;
    Vector3 size;
    for (int a = 0; a < 3; ++a)
    {
      if (block[a] >= m_First[a] + m_Size[a] || block[a] + width <= m_First[a])
      {
        return;
      }
      centre[a] = static_cast<double>(block[a] * m_Edge[a]) + 0.5 * static_cast<double>(width * m_Edge[a] - 1);
      size[a] = static_cast<double>(width * m_Edge[a] - 1) * m_Grid.spacing[a];
    }
    const PhantomModel::Levels levels = m_Model.EvaluateLevels(m_Grid.At(centre[0], centre[1], centre[2]));
    const signed char          content = Classify(m_Model, levels, 0.5 * size.norm() + m_Reach);
    if (content == Mixed && width > 1)
    {
      const long half = width / 2;
      for (int child = 0; child < 8; ++child)
      {
        this->Fill({ { block[0] + (child & 1 ? half : 0),
                       block[1] + (child & 2 ? half : 0),
                       block[2] + (child & 4 ? half : 0) } },
                   half);
      }
      return;
    }
    for (long k = std::max(block[2] - m_First[2], 0L); k < std::min(block[2] - m_First[2] + width, m_Size[2]); ++k)
    {
      for (long j = std::max(block[1] - m_First[1], 0L); j < std::min(block[1] - m_First[1] + width, m_Size[1]); ++j)
      {
        const auto row = m_Content.begin() + (k * m_Size[1] + j) * m_Size[0];
        std::fill(
          row + std::max(block[0] - m_First[0], 0L), row + std::min(block[0] - m_First[0] + width, m_Size[0]), content);
      }
    }
  }

  const PhantomModel &     m_Model;
  const PhantomGrid &      m_Grid;
  double                   m_Reach;
  std::array<long, 3>      m_Edge;
  std::array<long, 3>      m_First;
  std::array<long, 3>      m_Size;
  std::vector<signed char> m_Content;
};

PhantomSampler::PhantomSampler(PhantomModel::Pointer model, const PhantomGrid & grid, const Vector3 & sigma)
  : m_Model(std::move(model))
  , m_Grid(grid)
  , m_Fine(grid)
{
  Vector3 first;
  for (int a = 0; a < 3; ++a)
  {
    m_AnalyticSigma[a] = AnalyticPart(sigma[a]);
    m_Kernels[a] = MakeKernel(grid.spacing[a], sigma[a]);
    const double factor = static_cast<double>(m_Kernels[a].factor);
    m_Fine.spacing[a] = grid.spacing[a] / factor;
    first[a] = 0.5 / factor - 0.5;
  }
  m_Fine.origin = grid.At(first[0], first[1], first[2]);
  m_SoftTissue = m_Model->EvaluateMaterials(grid.origin, m_Model->EvaluateLevels(grid.origin))[Region::Outside];
}

PhantomSampler::Kernel
PhantomSampler::MakeKernel(double spacing, double sigma)
{
  Kernel       kernel;
  const double analytic = AnalyticPart(sigma);
  const double rest = std::sqrt(std::max(0.0, sigma * sigma - analytic * analytic));
  if (rest < NoSpread)
  {
    return kernel;
  }
  // A Gaussian sum of samples that are themselves blurred by a Gaussian. Along the axis the product of both has the
  // standard deviation `narrow`; with steps of h its sum is wrong by exp(-2 pi^2 narrow^2 / h^2) = 7e-4 of an edge.
  const double narrow = analytic * rest / sigma;
  kernel.factor = std::max(1L, static_cast<long>(std::ceil(spacing / (1.65 * narrow) - 1e-9)));
  const double step = spacing / static_cast<double>(kernel.factor);
  const auto   reach = static_cast<long>(std::ceil(PhantomModel::GaussianTail * rest / step));
  const long   count = 2 * reach + (kernel.factor % 2 == 0 ? 0 : 1);
  kernel.weights.resize(count);
  double sum = 0.0;
  for (long t = 0; t < count; ++t)
  {
    kernel.weights[t] = shapes::Gaussian((t - 0.5 * (count - 1)) * step / rest);
    sum += kernel.weights[t];
  }
  for (double & weight : kernel.weights)
  {
    weight /= sum;
  }
  return kernel;
}

double
PhantomSampler::SampleFine(signed char content, const Vector3 & x) const
{
  const PhantomModel::Levels levels = m_Model->EvaluateLevels(x);
  if (content == Neighbourhoods::Mixed)
  {
    content = Neighbourhoods::Classify(*m_Model, levels, PhantomModel::GaussianTail * m_AnalyticSigma.maxCoeff());
  }
  switch (content)
  {
    case Neighbourhoods::Mixed:
      return m_Model->BlurredDensity(x, m_Fine.axes, m_AnalyticSigma);
    case Region::Outside:
      return m_SoftTissue;
    default:
      return m_Model->EvaluateMaterials(x, levels)[content];
  }
}

bool
PhantomSampler::SampleFineRow(const Neighbourhoods & neighbourhoods,
                              long                   start,
                              long                   j,
                              long                   k,
                              std::vector<double> &  row) const
{
  const auto count = static_cast<long>(row.size());
  bool       hasBone = false;
  for (long i = 0; i < count;)
  {
    const signed char content = neighbourhoods(start + i, j, k);
    const long        end = std::min(count, neighbourhoods.GetColumnEnd(start + i) - start);
    if (content == Region::Outside)
    {
      std::fill(row.begin() + i, row.begin() + end, m_SoftTissue);
      i = end;
      continue;
    }
    hasBone = true;
    for (; i < end; ++i)
    {
      row[i] = this->SampleFine(content, m_Fine.At(start + i, j, k));
    }
  }
  return hasBone;
}

void
PhantomSampler::SampleFineSlice(const Neighbourhoods & neighbourhoods,
                                const PhantomBlock &   block,
                                long                   k,
                                std::vector<double> &  slice) const
{
  const Kernel &      kx = m_Kernels[0];
  const Kernel &      ky = m_Kernels[1];
  const auto          columns = static_cast<long>(block.size[0]);
  const auto          rows = static_cast<long>(block.size[1]);
  const auto          tapsX = static_cast<long>(kx.weights.size());
  const auto          tapsY = static_cast<long>(ky.weights.size());
  const long          fineColumns = (columns - 1) * kx.factor + tapsX;
  const long          fineRows = (rows - 1) * ky.factor + tapsY;
  std::vector<double> fine(fineColumns);
  std::vector<double> row(columns);
  std::fill(slice.begin(), slice.end(), 0.0);
  for (long j = 0; j < fineRows; ++j)
  {
    if (this->SampleFineRow(neighbourhoods, kx.First(block.start[0]), ky.First(block.start[1]) + j, k, fine))
    {
      for (long i = 0; i < columns; ++i)
      {
        row[i] = std::inner_product(kx.weights.begin(), kx.weights.end(), fine.begin() + i * kx.factor, 0.0);
      }
    }
    else
    {
      std::fill(row.begin(), row.end(), m_SoftTissue);
    }
    // Voxel row v takes fine row j with weight j - v * factor.
    const long first = std::max(0L, FloorDivide(j - tapsY, ky.factor) + 1);
    for (long v = first; v < rows && v * ky.factor <= j; ++v)
    {
      for (long i = 0; i < columns; ++i)
      {
        slice[v * columns + i] += ky.weights[j - v * ky.factor] * row[i];
      }
    }
  }
}

void
PhantomSampler::SampleDensity(const PhantomBlock & block, float * density) const
{
  PhantomBlock box;
  for (int a = 0; a < 3; ++a)
  {
    box.start[a] = m_Kernels[a].First(block.start[a]);
    box.size[a] = (block.size[a] - 1) * m_Kernels[a].factor + m_Kernels[a].weights.size();
  }
  const Neighbourhoods neighbourhoods(*m_Model, m_Fine, PhantomModel::GaussianTail * m_AnalyticSigma.maxCoeff(), box);

  const Kernel &      kz = m_Kernels[2];
  const auto          taps = static_cast<long>(kz.weights.size());
  const auto          slices = static_cast<long>(block.size[2]);
  const std::size_t   area = block.size[0] * block.size[1];
  std::vector<double> slice(area);
  std::fill(density, density + area * block.size[2], 0.0F);
  for (long k = 0; k < static_cast<long>(box.size[2]); ++k)
  {
    this->SampleFineSlice(neighbourhoods, block, box.start[2] + k, slice);
    const long first = std::max(0L, FloorDivide(k - taps, kz.factor) + 1);
    for (long v = first; v < slices && v * kz.factor <= k; ++v)
    {
      const double weight = kz.weights[k - v * kz.factor];
      for (std::size_t i = 0; i < area; ++i)
      {
        density[v * area + i] += static_cast<float>(weight * slice[i]);
      }
    }
  }
}

void
PhantomSampler::SampleRegions(const PhantomBlock & block, short * regions) const
{
  const Neighbourhoods neighbourhoods(*m_Model, m_Grid, 0.0, block);
  for (std::size_t k = 0; k < block.size[2]; ++k)
  {
    for (std::size_t j = 0; j < block.size[1]; ++j)
    {
      for (std::size_t i = 0; i < block.size[0]; ++i)
      {
        const long        x = block.start[0] + static_cast<long>(i);
        const long        y = block.start[1] + static_cast<long>(j);
        const long        z = block.start[2] + static_cast<long>(k);
        const signed char content = neighbourhoods(x, y, z);
        *regions++ =
          static_cast<short>(content == Neighbourhoods::Mixed ? m_Model->Region(m_Grid.At(x, y, z)) : content);
      }
    }
  }
}

double
PhantomNoise(std::uint64_t seed, std::uint64_t voxel)
{
  // Box-Muller on two hashes of the pair (seed, voxel).
  const std::uint64_t key = HashBits(HashBits(seed) ^ voxel);
  const double        u = UnitInterval(key);
  const double        v = UnitInterval(HashBits(key));
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * M_PI * v);
}
} // namespace bone
