/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLevelDensity.h"

#include "boneBernstein.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

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

/** Makes room for cells of a higher degree. */
void
Widen(MeshArrays & level, int degree)
{
  if (degree <= level.maximumDegree)
  {
    return;
  }
  const std::size_t   from = BernsteinCount(level.maximumDegree), to = BernsteinCount(degree);
  std::vector<double> wide(to * level.tetrahedra.size(), 0.0);
  for (std::size_t t = 0; t < level.tetrahedra.size(); ++t)
  {
    std::copy_n(&level.coefficients[from * t], from, &wide[to * t]);
  }
  level.coefficients = std::move(wide);
  level.maximumDegree = degree;
}

/** Points a cell of IntegratedError. Rules of fixed points keep away from faces, where the error is largest. */
constexpr std::size_t IntegrationPoints = 24;

/** The sample of a cell that is nearest to x. */
int
NearestSample(const DensitySamples & samples, const std::vector<int> & candidates, const Vector3 & x)
{
  return *std::min_element(candidates.begin(), candidates.end(), [&](int a, int b) {
    return (samples.All()[a].x - x).squaredNorm() < (samples.All()[b].x - x).squaredNorm();
  });
}
} // namespace

LevelDensity::LevelDensity(const MeshArrays &          before,
                           const std::vector<IdType> & parentCell,
                           const std::vector<IdType> & cellSlot,
                           const DensitySamples &      samples,
                           const std::vector<IdType> & sampleCell,
                           const Execution &           execution)
  : m_Before(before)
  , m_ParentCell(parentCell)
  , m_CellSlot(cellSlot)
  , m_Samples(samples)
  , m_SampleCell(sampleCell)
  , m_Execution(execution)
  , m_Locator(before)
{}

const DensityFitKernel &
LevelDensity::Kernel(int degree) const
{
  const auto at = m_Kernels.find(degree);
  return at != m_Kernels.end() ? at->second
                               : m_Kernels.emplace(degree, DensityFitKernel(degree, degree + 3)).first->second;
}

void
LevelDensity::FitCell(const MeshArrays & level, IdType t, const DensityFitKernel & kernel, double * coefficients) const
{
  const auto &             pattern = kernel.SamplePoints();
  const std::size_t        row = BernsteinCount(m_Before.maximumDegree);
  const Id4 &              v = level.tetrahedra[t];
  const std::vector<int> & candidates = m_Samples.InCell(m_CellSlot[t]);
  std::vector<double>      values(pattern.size());
  IdType                   at = candidates.empty() ? m_SampleCell[0] : m_SampleCell[candidates.front()];
  for (std::size_t k = 0; k < pattern.size(); ++k)
  {
    const Barycentric & mu = pattern[k];
    const Vector3       x =
      mu[0] * level.points[v[0]] + mu[1] * level.points[v[1]] + mu[2] * level.points[v[2]] + mu[3] * level.points[v[3]];
    if (!candidates.empty())
    {
      at = m_SampleCell[NearestSample(m_Samples, candidates, x)];
    }
    const CellLocation place = m_Locator.FindNearest(x, at);
    values[k] = BernsteinValue(m_Before.degree[place.cell], &m_Before.coefficients[row * place.cell], place.mu);
  }
  kernel.Fit(values.data(), coefficients);
}

void
LevelDensity::Fit(MeshArrays & level, int degree) const
{
  const std::size_t count = level.tetrahedra.size(), from = BernsteinCount(m_Before.maximumDegree);
  level.maximumDegree = degree;
  level.degree.assign(count, degree);
  for (std::size_t t = 0; t < count; ++t)
  {
    if (m_ParentCell[t] >= 0)
    {
      level.degree[t] = m_Before.degree[m_ParentCell[t]];
      level.maximumDegree = std::max(level.maximumDegree, level.degree[t]);
    }
  }
  const std::size_t        row = BernsteinCount(level.maximumDegree);
  const DensityFitKernel & kernel = Kernel(degree);
  level.quantity = m_Before.quantity;
  level.coefficients.assign(row * count, 0.0);
  m_Execution.Part(0.0, 0.5).For(
    count,
    [&](std::size_t t) {
      const IdType parent = m_ParentCell[t];
      if (parent >= 0)
      {
        std::copy_n(&m_Before.coefficients[from * parent], std::min(from, row), &level.coefficients[row * t]);
      }
      else
      {
        FitCell(level, static_cast<IdType>(t), kernel, &level.coefficients[row * t]);
      }
    },
    16);
}

double
LevelDensity::CellSquares(const MeshArrays & level, IdType t, int degree, const double * coefficients) const
{
  double sum = 0.0;
  for (int s : m_Samples.InCell(m_CellSlot[t]))
  {
    const auto &      sample = m_Samples.All()[s];
    const Barycentric mu = Clamped(CoordinatesIn(level, t, sample.x));
    const double      error = BernsteinValue(degree, coefficients, mu) - sample.value;
    sum += sample.weight * error * error;
  }
  return sum;
}

LevelDensity::Errors
LevelDensity::Measure(const MeshArrays & level) const
{
  const std::size_t row = BernsteinCount(level.maximumDegree), count = level.tetrahedra.size();
  Errors            errors;
  errors.squares.resize(count);
  m_Execution.Silent().For(
    count,
    [&](std::size_t t) {
      errors.squares[t] = CellSquares(level, static_cast<IdType>(t), level.degree[t], &level.coefficients[row * t]);
    },
    256);
  errors.square = std::accumulate(errors.squares.begin(), errors.squares.end(), 0.0);
  for (const auto & sample : m_Samples.All())
  {
    errors.weight += sample.weight;
  }
  return errors;
}

double
LevelDensity::Error(const MeshArrays & level) const
{
  const Errors errors = Measure(level);
  return errors.weight > 0 ? std::sqrt(errors.square / errors.weight) : 0.0;
}

double
LevelDensity::IntegratedError(const MeshArrays & finest, const MeshArrays & level) const
{
  const std::size_t   count = finest.tetrahedra.size(), rowFinest = BernsteinCount(finest.maximumDegree);
  const std::size_t   row = BernsteinCount(level.maximumDegree);
  const TetraLocator  locator(level);
  std::vector<IdType> start(count, 0);
  for (std::size_t t = 0; t < m_CellSlot.size(); ++t)
  {
    for (int s : m_Samples.InCell(m_CellSlot[t]))
    {
      start[s / DensitySamples::SamplesPerCell] = static_cast<IdType>(t);
    }
  }
  std::vector<double> squares(count, 0.0), volumes(count, 0.0);
  m_Execution.Part(0.5, 1.0).For(
    count,
    [&](std::size_t t) {
      const Id4 &  v = finest.tetrahedra[t];
      const auto & p = finest.points;
      IdType       at = start[t];
      volumes[t] = SignedVolume(p[v[0]], p[v[1]], p[v[2]], p[v[3]]);
      for (std::size_t k = 0; k < IntegrationPoints; ++k)
      {
        const Barycentric  mu = EvenlySpread(t * IntegrationPoints + k);
        const Vector3      x = mu[0] * p[v[0]] + mu[1] * p[v[1]] + mu[2] * p[v[2]] + mu[3] * p[v[3]];
        const CellLocation place = locator.FindNearest(x, at);
        at = place.cell;
        const double error = BernsteinValue(finest.degree[t], &finest.coefficients[rowFinest * t], mu) -
                             BernsteinValue(level.degree[at], &level.coefficients[row * at], place.mu);
        squares[t] += volumes[t] / IntegrationPoints * error * error;
      }
    },
    16);
  const double volume = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / volume);
}

double
LevelDensity::Elevate(MeshArrays & level, double bound, int maximumDegree) const
{
  // A step takes away about this share of a cell's squared error, going by smooth densities.
  constexpr double Gain = 0.4;
  Errors           errors = Measure(level);
  std::vector<int> tried = level.degree;
  while (errors.square > bound * bound * errors.weight)
  {
    std::vector<std::pair<double, IdType>> worst;
    for (std::size_t t = 0; t < errors.squares.size(); ++t)
    {
      if (m_ParentCell[t] < 0 && tried[t] < maximumDegree && errors.squares[t] > 0)
      {
        worst.emplace_back(-errors.squares[t], static_cast<IdType>(t));
      }
    }
    if (worst.empty())
    {
      break;
    }
    std::sort(worst.begin(), worst.end());
    std::size_t count = 0;
    for (double excess = errors.square - bound * bound * errors.weight; count < worst.size() && excess > 0; ++count)
    {
      excess += Gain * worst[count].first;
    }
    worst.resize(count);
    int highest = 0;
    for (const auto & cell : worst)
    {
      highest = std::max(highest, ++tried[cell.second]);
      Kernel(tried[cell.second]);
    }
    Widen(level, highest);
    const std::size_t row = BernsteinCount(level.maximumDegree);
    m_Execution.Silent().For(
      count,
      [&](std::size_t k) {
        const IdType        t = worst[k].second;
        std::vector<double> coefficients(BernsteinCount(tried[t]));
        FitCell(level, t, m_Kernels.at(tried[t]), coefficients.data());
        const double square = CellSquares(level, t, tried[t], coefficients.data());
        if (square < errors.squares[t])
        {
          errors.squares[t] = square;
          level.degree[t] = tried[t];
          std::copy(coefficients.begin(), coefficients.end(), &level.coefficients[row * t]);
        }
      },
      16);
    errors.square = std::accumulate(errors.squares.begin(), errors.squares.end(), 0.0);
  }
  return errors.weight > 0 ? std::sqrt(errors.square / errors.weight) : 0.0;
}

double
LevelDensity::FitWithin(MeshArrays & level, const CellFits & fits, double bound) const
{
  std::vector<CellFits::Fit> found(level.tetrahedra.size());
  m_Execution.Silent().For(
    found.size(),
    [&](std::size_t t) {
      if (m_ParentCell[t] < 0)
      {
        const Id4 &  v = level.tetrahedra[t];
        const auto & p = level.points;
        const auto & samples = m_Samples.InCell(m_CellSlot[t]);
        const IdType hint = samples.empty() ? -1 : samples.front() / DensitySamples::SamplesPerCell;
        found[t] = fits.FitCell({ p[v[0]], p[v[1]], p[v[2]], p[v[3]] }, bound, hint);
      }
    },
    16);
  int    highest = level.maximumDegree;
  double largest = 0.0;
  for (const auto & fit : found)
  {
    highest = std::max(highest, fit.degree);
    largest = std::max(largest, fit.error);
  }
  Widen(level, highest);
  const std::size_t row = BernsteinCount(level.maximumDegree);
  for (std::size_t t = 0; t < found.size(); ++t)
  {
    if (m_ParentCell[t] < 0)
    {
      level.degree[t] = found[t].degree;
      std::fill_n(&level.coefficients[row * t], row, 0.0);
      std::copy(found[t].coefficients.begin(), found[t].coefficients.end(), &level.coefficients[row * t]);
    }
  }
  return largest;
}
} // namespace bone
