/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTilingMetric.h"

#include <cmath>
#include <stdexcept>

namespace bone
{
double
SpanLengthMetric::Evaluate(const TilingStep & step) const
{
  double sum = 0.0;
  for (int e = 0; e < step.numberOfEdges; ++e)
  {
    sum += (step.edges[2 * e + 1] - step.edges[2 * e]).norm();
  }
  return sum;
}

double
AreaMetric::Evaluate(const TilingStep & step) const
{
  double sum = 0.0;
  for (int f = 0; f < step.numberOfFaces; ++f)
  {
    const Vector3 & a = step.faces[3 * f];
    sum += 0.5 * (step.faces[3 * f + 1] - a).cross(step.faces[3 * f + 2] - a).norm();
  }
  return sum;
}

double
VolumeMetric::Evaluate(const TilingStep & step) const
{
  return -step.volume;
}

DensityDeviationMetric::DensityDeviationMetric(DensitySampler sampler)
  : m_Sampler(std::move(sampler))
{
  if (!m_Sampler)
  {
    throw std::invalid_argument("The metric 'density' needs a CT; give one or choose another metric.");
  }
}

double
DensityDeviationMetric::Evaluate(const TilingStep & step) const
{
  constexpr int samples = 5;
  double        cost = 0.0;
  for (int e = 0; e < step.numberOfEdges; ++e)
  {
    const Vector3 & a = step.edges[2 * e];
    const Vector3 & b = step.edges[2 * e + 1];
    double          sum = 0.0, squares = 0.0;
    int             count = 0;
    for (int i = 0; i < samples; ++i)
    {
      const double value = m_Sampler(a + (i + 0.5) / samples * (b - a));
      if (std::isfinite(value))
      {
        sum += value;
        squares += value * value;
        ++count;
      }
    }
    if (count > 1)
    {
      const double mean = sum / count;
      cost += (b - a).norm() * std::sqrt(std::max(0.0, squares / count - mean * mean));
    }
  }
  return cost;
}

CombinedMetric::CombinedMetric(DensitySampler sampler, double weight)
  : m_Weight(weight)
{
  if (sampler)
  {
    m_Density = std::make_unique<DensityDeviationMetric>(std::move(sampler));
  }
}

double
CombinedMetric::Evaluate(const TilingStep & step) const
{
  return m_Span.Evaluate(step) + (m_Density ? m_Weight * m_Density->Evaluate(step) : 0.0);
}

std::shared_ptr<const TilingMetric>
MakeTilingMetric(TilingMetricKind kind, const DensitySampler & sampler)
{
  switch (kind)
  {
    case TilingMetricKind::Span:
      return std::make_shared<SpanLengthMetric>();
    case TilingMetricKind::Area:
      return std::make_shared<AreaMetric>();
    case TilingMetricKind::Volume:
      return std::make_shared<VolumeMetric>();
    case TilingMetricKind::Density:
      return std::make_shared<DensityDeviationMetric>(sampler);
    default:
      return std::make_shared<CombinedMetric>(sampler);
  }
}
} // namespace bone
