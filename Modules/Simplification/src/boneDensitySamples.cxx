/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneDensitySamples.h"

#include "boneBernstein.h"
#include "boneTetraLocator.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
/** More samples than this around a vertex or in a cell are thinned out for the estimate. */
constexpr std::size_t EnoughSamples = 120;

/** Every stride-th value. */
std::vector<int>
Thinned(const std::vector<int> & values, std::size_t stride)
{
  std::vector<int> kept;
  for (std::size_t i = 0; i < values.size(); i += stride)
  {
    kept.push_back(values[i]);
  }
  return kept;
}

int
TermCount(int degree)
{
  return degree == 0 ? 1 : degree == 1 ? 4 : 10;
}

/** Monomials of degree 2 at most; their first 1 and 4 are those of degrees 0 and 1. */
void
Monomials(const Vector3 & x, double * m)
{
  m[0] = 1;
  m[1] = x[0];
  m[2] = x[1];
  m[3] = x[2];
  m[4] = x[0] * x[0];
  m[5] = x[1] * x[1];
  m[6] = x[2] * x[2];
  m[7] = x[0] * x[1];
  m[8] = x[1] * x[2];
  m[9] = x[2] * x[0];
}

double
PercentileRange(const std::vector<DensitySamples::Sample> & samples)
{
  std::vector<double> values;
  for (const auto & sample : samples)
  {
    values.push_back(sample.value);
  }
  std::sort(values.begin(), values.end());
  const double last = static_cast<double>(values.size() - 1);
  const double range = values[std::lround(0.99 * last)] - values[std::lround(0.01 * last)];
  return range > 0 ? range : 1.0;
}
} // namespace

DensitySamples::DensitySamples(const MeshArrays & mesh, const Execution & execution)
  : m_InCell(mesh.tetrahedra.size())
  , m_CellError(mesh.tetrahedra.size(), 0.0)
{
  if (!mesh.HasDensity())
  {
    return;
  }
  const std::size_t row = BernsteinCount(mesh.maximumDegree);
  m_FitDegree = std::min(2, mesh.maximumDegree);
  m_Samples.resize(SamplesPerCell * mesh.tetrahedra.size());
  execution.For(
    mesh.tetrahedra.size(),
    [&](std::size_t t) {
      std::size_t     s = SamplesPerCell * t;
      const Id4 &     v = mesh.tetrahedra[t];
      const Vector3 * p[4] = { &mesh.points[v[0]], &mesh.points[v[1]], &mesh.points[v[2]], &mesh.points[v[3]] };
      const double    weight = SignedVolume(*p[0], *p[1], *p[2], *p[3]) / SamplesPerCell;
      for (int i = 0; i < 4; ++i)
      {
        for (int j = i; j < 4; ++j)
        {
          Barycentric mu = Barycentric::Constant(0.125);
          mu[i] += 0.25;
          mu[j] += 0.25;
          m_InCell[t].push_back(static_cast<int>(s));
          m_Samples[s++] = { mu[0] * *p[0] + mu[1] * *p[1] + mu[2] * *p[2] + mu[3] * *p[3],
                             BernsteinValue(mesh.degree[t], &mesh.coefficients[row * t], mu),
                             weight };
        }
      }
    },
    256);
  m_Range = m_Samples.empty() ? 1.0 : PercentileRange(m_Samples);
}

double
DensitySamples::FitResidual(const std::vector<int> & samples) const
{
  const std::size_t count = samples.size();
  const int         degree = std::min(m_FitDegree, count >= 20 ? 2 : count >= 8 ? 1 : 0);
  const int         n = TermCount(degree);
  Vector3           centre = Vector3::Zero();
  for (int s : samples)
  {
    centre += m_Samples[s].x / static_cast<double>(count);
  }
  double scale = 0.0;
  for (int s : samples)
  {
    scale = std::max(scale, (m_Samples[s].x - centre).cwiseAbs().maxCoeff());
  }
  scale = scale > 0 ? 1.0 / scale : 1.0;
  // Values are taken from the first sample on, so that a constant density leaves no rounding behind.
  const double                  origin = m_Samples[samples.front()].value;
  Eigen::Matrix<double, 10, 10> gram = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 1>  right = Eigen::Matrix<double, 10, 1>::Zero(), m;
  double                        squares = 0.0, total = 0.0;
  for (int s : samples)
  {
    const Sample & sample = m_Samples[s];
    const double   value = sample.value - origin;
    Monomials((sample.x - centre) * scale, m.data());
    for (int i = 0; i < n; ++i)
    {
      const double wi = sample.weight * m[i];
      right[i] += wi * value;
      for (int j = 0; j <= i; ++j)
      {
        gram(i, j) += wi * m[j];
      }
    }
    squares += sample.weight * value * value;
    total += sample.weight;
  }
  if (!(squares > 0))
  {
    return 0.0;
  }
  for (int i = 0; i < n; ++i)
  {
    gram(i, i) += 1e-9 * total;
  }
  const auto            lower = gram.topLeftCorner(n, n).selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd solution = Eigen::MatrixXd(lower).ldlt().solve(right.head(n));
  return std::max(0.0, squares - solution.dot(right.head(n)));
}

double
DensitySamples::RemovalCost(const TetraComplex & complex, IdType v) const
{
  if (IsEmpty())
  {
    return 0.0;
  }
  // By region: between regions the density jumps, and keeps doing so.
  std::vector<std::pair<int, std::vector<int>>> regions;
  double                                        now = 0.0;
  std::size_t                                   count = 0;
  for (IdType t : complex.Star(v))
  {
    now += m_CellError[t];
    count += m_InCell[t].size();
    const int region = complex.Region(t);
    auto      at = std::find_if(regions.begin(), regions.end(), [region](const auto & r) { return r.first == region; });
    if (at == regions.end())
    {
      regions.emplace_back(region, std::vector<int>());
      at = regions.end() - 1;
    }
    at->second.insert(at->second.end(), m_InCell[t].begin(), m_InCell[t].end());
  }
  double            cost = 0.0;
  const std::size_t stride = count / EnoughSamples + 1;
  for (auto & region : regions)
  {
    const std::vector<int> & samples = region.second;
    if (samples.empty())
    {
      continue;
    }
    cost += static_cast<double>(stride) * FitResidual(stride > 1 ? Thinned(samples, stride) : samples);
  }
  return std::max(0.0, cost - now);
}

std::vector<int>
DensitySamples::TakeFrom(const std::vector<IdType> & cells)
{
  std::vector<int> taken;
  for (IdType t : cells)
  {
    taken.insert(taken.end(), m_InCell[t].begin(), m_InCell[t].end());
    m_InCell[t].clear();
    m_CellError[t] = 0.0;
  }
  return taken;
}

void
DensitySamples::GiveTo(const TetraComplex &        complex,
                       const std::vector<int> &    samples,
                       const std::vector<IdType> & cells)
{
  if (IsEmpty())
  {
    return;
  }
  m_InCell.resize(complex.Size());
  m_CellError.resize(complex.Size(), 0.0);
  struct Planes
  {
    Vector3 normal[4]; // gradient of each barycentric coordinate
    Vector3 origin;
  };
  std::vector<Planes> planes(cells.size());
  const auto &        p = complex.Points();
  for (std::size_t c = 0; c < cells.size(); ++c)
  {
    const Id4 &   v = complex.Cell(cells[c]);
    const Vector3 u = p[v[1]] - p[v[0]], w = p[v[2]] - p[v[0]], x = p[v[3]] - p[v[0]];
    const double  inverse = 1.0 / u.cross(w).dot(x);
    planes[c].origin = p[v[0]];
    planes[c].normal[1] = w.cross(x) * inverse;
    planes[c].normal[2] = x.cross(u) * inverse;
    planes[c].normal[3] = u.cross(w) * inverse;
  }
  for (int s : samples)
  {
    double      best = -std::numeric_limits<double>::max();
    std::size_t at = 0;
    for (std::size_t c = 0; c < cells.size() && best < 0; ++c)
    {
      const Vector3 d = m_Samples[s].x - planes[c].origin;
      const double  m1 = planes[c].normal[1].dot(d), m2 = planes[c].normal[2].dot(d), m3 = planes[c].normal[3].dot(d);
      const double  least = std::min({ 1.0 - m1 - m2 - m3, m1, m2, m3 });
      if (least > best)
      {
        best = least;
        at = c;
      }
    }
    m_InCell[cells[at]].push_back(s);
  }
  for (IdType t : cells)
  {
    MeasureCell(t);
  }
}

void
DensitySamples::MeasureCell(IdType t)
{
  const std::size_t stride = m_InCell[t].size() / EnoughSamples + 1;
  m_CellError[t] = m_InCell[t].empty() ? 0.0
                                       : static_cast<double>(stride) *
                                           FitResidual(stride > 1 ? Thinned(m_InCell[t], stride) : m_InCell[t]);
}

void
DensitySamples::Distribute(const TetraComplex & complex, const Execution & execution)
{
  if (IsEmpty())
  {
    return;
  }
  MeshArrays          mesh;
  std::vector<IdType> slots;
  mesh.points = complex.Points();
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    if (complex.IsAlive(t))
    {
      mesh.tetrahedra.push_back(complex.Cell(t));
      slots.push_back(t);
    }
  }
  const TetraLocator  locator(mesh);
  std::vector<IdType> cells(m_Samples.size());
  execution.For(
    m_Samples.size(), [&](std::size_t s) { cells[s] = slots[locator.FindNearest(m_Samples[s].x).cell]; }, 1024);
  m_InCell.assign(complex.Size(), {});
  m_CellError.assign(complex.Size(), 0.0);
  for (std::size_t s = 0; s < cells.size(); ++s)
  {
    m_InCell[cells[s]].push_back(static_cast<int>(s));
  }
  execution.For(
    slots.size(), [&](std::size_t i) { MeasureCell(slots[i]); }, 64);
}
} // namespace bone
