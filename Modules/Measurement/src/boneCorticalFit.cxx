/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCorticalFit.h"

#include "boneCorticalProfile.h"

#include <Eigen/Core>
#include <unsupported/Eigen/NonLinearOptimization>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr double      BinWidth = 0.25;        // mm, of the means that the fit starts from
constexpr double      ThinStart = 0.5;        // mm: thickness at the start where no cortex stands out
constexpr double      GapReach = 1.0;         // mm: how deep below the surface the gap to another bone may lie
constexpr double      LeastThickness = 0.02;  // mm: less is none
constexpr double      LargestBlur = 3.0;      // pixels
constexpr double      LargestResidual = 0.25; // of the step at the periosteal edge
constexpr std::size_t LeastSamples = 12;
constexpr std::size_t LeastOutside = 3; // samples on the outer side of the surface

double
Normal(double x)
{
  return 0.5 * std::erfc(-x * M_SQRT1_2);
}

double
NormalDensity(double x)
{
  return std::exp(-0.5 * x * x) / std::sqrt(2.0 * M_PI);
}

/** Residuals and their derivatives, for Eigen. Parameters: outer, thickness, outside, inside, and those of cortical and
 * blur that are fitted. */
class Residuals
{
public:
  Residuals(const std::vector<CorticalSample> & samples, const BlurredCortex & start, const CorticalFitRules & rules)
    : m_Samples(samples)
    , m_Start(start)
    , m_FitsCortical(std::isnan(rules.cortical))
    , m_FitsBlur(!(rules.blur > 0.0))
  {}

  Eigen::VectorXd
  GetParameters() const
  {
    Eigen::VectorXd x(4 + (m_FitsCortical ? 1 : 0) + (m_FitsBlur ? 1 : 0));
    x.head<4>() << m_Start.outer, m_Start.thickness, m_Start.outside, m_Start.inside;
    if (m_FitsCortical)
    {
      x[4] = m_Start.cortical;
    }
    if (m_FitsBlur)
    {
      x[x.size() - 1] = m_Start.blur;
    }
    return x;
  }

  BlurredCortex
  MakeCortex(const Eigen::VectorXd & x) const
  {
    BlurredCortex cortex = m_Start;
    cortex.outer = x[0];
    cortex.thickness = x[1];
    cortex.outside = x[2];
    cortex.inside = x[3];
    cortex.cortical = m_FitsCortical ? x[4] : m_Start.cortical;
    cortex.blur = m_FitsBlur ? std::abs(x[x.size() - 1]) : m_Start.blur;
    return cortex;
  }

  int
  values() const
  {
    return static_cast<int>(m_Samples.size());
  }

  int
  operator()(const Eigen::VectorXd & x, Eigen::VectorXd & residuals) const
  {
    const BlurredCortex cortex = this->MakeCortex(x);
    for (int i = 0; i < this->values(); ++i)
    {
      const CorticalSample & sample = m_Samples[static_cast<std::size_t>(i)];
      residuals[i] = cortex(sample.depth) - sample.value;
    }
    return 0;
  }

  int
  df(const Eigen::VectorXd & x, Eigen::MatrixXd & jacobian) const
  {
    const BlurredCortex c = this->MakeCortex(x);
    const double        first = c.cortical - c.outside, second = c.inside - c.cortical;
    for (int i = 0; i < this->values(); ++i)
    {
      const double a = (m_Samples[static_cast<std::size_t>(i)].depth - c.outer) / c.blur;
      const double b = a - c.thickness / c.blur;
      const double pa = Normal(a), pb = Normal(b);
      const double da = first * NormalDensity(a) / c.blur, db = second * NormalDensity(b) / c.blur;
      jacobian(i, 0) = -da - db;
      jacobian(i, 1) = -db;
      jacobian(i, 2) = 1.0 - pa;
      jacobian(i, 3) = pb;
      if (m_FitsCortical)
      {
        jacobian(i, 4) = pa - pb;
      }
      if (m_FitsBlur)
      {
        jacobian(i, x.size() - 1) = (-a * da - b * db) * (x[x.size() - 1] < 0.0 ? -1.0 : 1.0);
      }
    }
    return 0;
  }

private:
  const std::vector<CorticalSample> & m_Samples;
  BlurredCortex                       m_Start;
  bool                                m_FitsCortical;
  bool                                m_FitsBlur;
};

/** Means of the samples in bins, bins without samples from their neighbours. `samples` ascend in depth. */
CorticalProfile
MakeProfile(const std::vector<CorticalSample> & samples)
{
  CorticalProfile profile;
  profile.step = BinWidth;
  profile.lead = std::max(0, static_cast<int>(std::floor(-samples.front().depth / BinWidth)));
  const auto          count = static_cast<std::size_t>(samples.back().depth / BinWidth + profile.lead + 1.5);
  std::vector<double> sums(count, 0.0), weights(count, 0.0);
  for (const CorticalSample & sample : samples)
  {
    const double place = sample.depth / BinWidth + profile.lead;
    const auto   bin = static_cast<std::size_t>(std::clamp(place + 0.5, 0.0, count - 0.5));
    sums[bin] += sample.value;
    weights[bin] += 1.0;
  }
  for (std::size_t k = 0; k < count; ++k)
  {
    std::size_t reach = 0;
    double      sum = sums[k], weight = weights[k];
    while (weight <= 0.0)
    {
      ++reach;
      for (const std::size_t at : { k >= reach ? k - reach : count, k + reach })
      {
        sum += at < count ? sums[at] : 0.0;
        weight += at < count ? weights[at] : 0.0;
      }
    }
    profile.values.push_back(sum / weight);
  }
  return profile;
}

/** Leaves out what lies further outside than the least of the profile and is denser than it: another bone. */
void
LeaveOutNeighbour(const CorticalProfile & profile, double contrast, std::vector<CorticalSample> & samples)
{
  const auto begin = profile.values.begin();
  const auto search = std::min<std::size_t>(profile.values.size(), profile.lead + 1 + GapReach / BinWidth);
  const auto least = std::min_element(begin, begin + static_cast<std::ptrdiff_t>(search));
  auto       end = least;
  while (end != begin && *(end - 1) < *least + contrast)
  {
    --end;
  }
  if (end != begin)
  {
    const double from = (static_cast<double>(end - begin) - 0.5 - profile.lead) * profile.step;
    samples.erase(
      std::remove_if(samples.begin(), samples.end(), [from](const CorticalSample & s) { return s.depth < from; }),
      samples.end());
  }
}

void
KeepBetween(double from, double to, std::vector<CorticalSample> & samples)
{
  samples.erase(std::remove_if(samples.begin(),
                               samples.end(),
                               [from, to](const CorticalSample & s) { return !(s.depth >= from && s.depth <= to); }),
                samples.end());
}

double
MeanBetween(const std::vector<CorticalSample> & samples, double from, double to, double otherwise)
{
  double sum = 0.0, count = 0.0;
  for (const CorticalSample & sample : samples)
  {
    if (sample.depth >= from && sample.depth <= to)
    {
      sum += sample.value;
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : otherwise;
}

BlurredCortex
MakeStart(const CorticalProfile &             profile,
          const CorticalEdges &               edges,
          const std::vector<CorticalSample> & samples,
          const CorticalFitRules &            rules)
{
  BlurredCortex start;
  start.blur = rules.blur > 0.0 ? rules.blur : edges.blur > 0.0 ? edges.blur : 0.5 * rules.pixel;
  const bool   found = edges.kind == CorticalEdges::Kind::Found;
  const double inner = found ? edges.inner : edges.outer + ThinStart;
  start.outer = std::clamp(found ? edges.outer : 0.0, -rules.largestOffset, rules.largestOffset);
  const double least = rules.blur > 0.0 ? 0.5 * rules.blur : 0.25 * rules.pixel;
  start.thickness = std::max(ThicknessOfBlurredLayer(inner - start.outer, start.blur), least);
  const double peak = *std::max_element(profile.values.begin(), profile.values.end());
  start.cortical = std::isnan(rules.cortical) ? peak : rules.cortical;
  start.outside = MeanBetween(samples, -1e9, start.outer - 2.0 * start.blur, profile.values.front());
  start.inside = MeanBetween(samples, inner + 2.0 * start.blur, 1e9, profile.values.back());
  return start;
}

CorticalFit
Minimize(const std::vector<CorticalSample> & samples, const BlurredCortex & start, const CorticalFitRules & rules)
{
  CorticalFit     fit;
  Residuals       residuals(samples, start, rules);
  Eigen::VectorXd x = residuals.GetParameters();
  if (residuals.values() < static_cast<int>(LeastSamples))
  {
    return fit;
  }
  Eigen::LevenbergMarquardt<Residuals> solver(residuals);
  solver.parameters.maxfev = 100;
  solver.minimize(x);
  fit.cortex = residuals.MakeCortex(x);
  fit.residual = std::sqrt(solver.fvec.squaredNorm() / static_cast<double>(samples.size()));
  fit.status = CorticalStatus::Found;
  return fit;
}

bool
IsCortex(const CorticalFit & fit, const CorticalFitRules & rules)
{
  const BlurredCortex & c = fit.cortex;
  const double          contrast = rules.minimumContrast;
  return std::isfinite(c.thickness) && c.thickness > LeastThickness && std::abs(c.outer) <= rules.largestOffset &&
         c.cortical - c.outside > contrast && c.cortical - c.inside > contrast && c.blur < LargestBlur * rules.pixel &&
         fit.residual < LargestResidual * (c.cortical - c.outside);
}
} // namespace

double
BlurredCortex::operator()(double depth) const
{
  const double a = (depth - outer) / blur;
  return outside + (cortical - outside) * Normal(a) + (inside - cortical) * Normal(a - thickness / blur);
}

CorticalFit
FitCortex(std::vector<CorticalSample> samples, const CorticalFitRules & rules)
{
  CorticalFit fit;
  KeepBetween(-rules.outsideReach, 1e9, samples);
  std::sort(samples.begin(), samples.end(), [](const CorticalSample & a, const CorticalSample & b) {
    return a.depth != b.depth ? a.depth < b.depth : a.value < b.value;
  });
  const auto outside =
    std::count_if(samples.begin(), samples.end(), [](const CorticalSample & s) { return s.depth < 0.0; });
  if (samples.size() < LeastSamples || outside < static_cast<std::ptrdiff_t>(LeastOutside) ||
      samples.back().depth < rules.pixel)
  {
    return fit;
  }
  const CorticalProfile profile = MakeProfile(samples);
  LeaveOutNeighbour(profile, rules.minimumContrast, samples);
  CorticalRules half;
  half.pixel = rules.pixel;
  half.minimumContrast = rules.minimumContrast;
  const CorticalEdges edges = FindCorticalEdges(profile, half);
  if (edges.kind == CorticalEdges::Kind::Solid)
  {
    fit.status = CorticalStatus::Solid;
    return fit;
  }
  const double        deepest = samples.back().depth;
  const BlurredCortex start = MakeStart(profile, edges, samples, rules);
  KeepBetween(-rules.outsideReach, start.outer + start.thickness + rules.insideReach, samples);
  fit = Minimize(samples, start, rules);
  // Where no layer stands out, the edge may be anywhere near by.
  for (const double outer : { -0.5 * rules.largestOffset, 0.5 * rules.largestOffset })
  {
    if (edges.kind == CorticalEdges::Kind::None)
    {
      BlurredCortex moved = start;
      moved.outer = outer;
      const CorticalFit other = Minimize(samples, moved, rules);
      fit = other.residual < fit.residual ? other : fit;
    }
  }
  if (fit.status == CorticalStatus::Found && !IsCortex(fit, rules))
  {
    fit.status = CorticalStatus::None;
  }
  if (fit.status == CorticalStatus::Found && fit.cortex.outer + fit.cortex.thickness > deepest)
  {
    fit.status = CorticalStatus::Solid;
  }
  return fit;
}
} // namespace bone
