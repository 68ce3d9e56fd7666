/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourSampling.h"

#include "bonePlanarCrossing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
// Neighbouring samples' spacing changes by at most this per unit of length.
constexpr double Gradation = 0.3;
constexpr int    SamplesPerSpan = 8;
constexpr int    MostRefinements = 4;

struct LoopPlan
{
  Polygon              given;
  BSplineFit           fit;
  double               scale{ 1.0 }; // of spacing and tolerance
  bool                 keep{ false };
  Polygon              sampled;
  std::vector<Vector2> curve;  // fine points on the spline
  std::vector<double>  target; // spacing wanted there
};

double
DistanceToPolygon(const Vector2 & q, const Polygon & polygon)
{
  double best = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vector2 & a = polygon[i];
    const Vector2   d = polygon[(i + 1) % polygon.size()] - a;
    const double    squared = d.squaredNorm();
    const double    t = squared > 0.0 ? std::clamp((q - a).dot(d) / squared, 0.0, 1.0) : 0.0;
    best = std::min(best, (q - a - t * d).squaredNorm());
  }
  return std::sqrt(best);
}

double
Perimeter(const Polygon & polygon)
{
  double length = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    length += (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
  }
  return length;
}

// The polygon with points on its long edges, so that none is longer than `longest`.
Polygon
SplitEdges(const Polygon & polygon, double longest)
{
  Polygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vector2 a = polygon[i];
    const Vector2 d = polygon[(i + 1) % polygon.size()] - a;
    const int     parts = std::max(1, static_cast<int>(std::ceil(d.norm() / longest)));
    for (int k = 0; k < parts; ++k)
    {
      result.push_back(a + static_cast<double>(k) / parts * d);
    }
  }
  return result;
}

// Cumulative share of samples along the fine points, from the target spacing made gradual.
std::vector<double>
ShareAlong(LoopPlan & plan)
{
  const std::size_t   n = plan.curve.size();
  std::vector<double> step(n);
  for (std::size_t i = 0; i < n; ++i)
  {
    step[i] = (plan.curve[(i + 1) % n] - plan.curve[i]).norm();
  }
  for (std::size_t k = 0; k < 2 * n; ++k)
  {
    const std::size_t i = k % n;
    const std::size_t next = (i + 1) % n;
    plan.target[next] = std::min(plan.target[next], plan.target[i] + Gradation * step[i]);
  }
  for (std::size_t k = 2 * n; k-- > 0;)
  {
    const std::size_t i = k % n;
    plan.target[i] = std::min(plan.target[i], plan.target[(i + 1) % n] + Gradation * step[i]);
  }
  std::vector<double> share(1, 0.0);
  for (std::size_t i = 0; i < n; ++i)
  {
    share.push_back(share.back() + 0.5 * step[i] * (1.0 / plan.target[i] + 1.0 / plan.target[(i + 1) % n]));
  }
  return share;
}

class SliceSampler
{
public:
  SliceSampler(std::vector<Polygon> given, const SamplingParameters & parameters, SamplingReport & report)
    : m_Parameters(parameters)
    , m_Report(report)
    , m_Plans(given.size())
  {
    for (std::size_t c = 0; c < given.size(); ++c)
    {
      m_Plans[c].given = std::move(given[c]);
    }
  }

  std::vector<Polygon>
  Run()
  {
    for (std::size_t c = 0; c < m_Plans.size(); ++c)
    {
      this->Fit(m_Plans[c]);
    }
    std::vector<int> dirty(m_Plans.size(), 1);
    for (bool again = true; again;)
    {
      for (std::size_t c = 0; c < m_Plans.size(); ++c)
      {
        if (dirty[c] != 0)
        {
          this->Sample(c);
        }
      }
      dirty = this->FindConflicts();
      again = false;
      for (std::size_t c = 0; c < m_Plans.size(); ++c)
      {
        dirty[c] = dirty[c] != 0 && this->Refine(m_Plans[c]);
        again = again || dirty[c] != 0;
      }
    }
    std::vector<Polygon> result;
    for (LoopPlan & plan : m_Plans)
    {
      m_Report.refined += plan.scale < 1.0;
      m_Report.unfitted += plan.keep;
      m_Report.largestError = plan.keep ? m_Report.largestError : std::max(m_Report.largestError, plan.fit.deviation);
      result.push_back(std::move(plan.sampled));
    }
    return result;
  }

private:
  void
  Fit(LoopPlan & plan) const
  {
    const double length = Perimeter(plan.given);
    const double longest = std::max(0.25 * m_Parameters.maximumSpacing * plan.scale, length / 2000.0);
    Polygon      points = SplitEdges(plan.given, std::min(longest, length / 16.0));
    plan.fit = FitClosedBSplineWithin(points, m_Parameters.tolerance * plan.scale);
    const auto m = plan.fit.curve.GetNumberOfControlPoints();
    plan.curve.clear();
    for (std::size_t i = 0; i < SamplesPerSpan * m; ++i)
    {
      plan.curve.push_back(plan.fit.curve.Evaluate(static_cast<double>(i) / SamplesPerSpan));
    }
  }

  double
  TargetSpacing(std::size_t c, std::size_t i) const
  {
    const LoopPlan & plan = m_Plans[c];
    const double     curvature = std::abs(plan.fit.curve.Curvature(static_cast<double>(i) / SamplesPerSpan));
    double           spacing = std::sqrt(8.0 * m_Parameters.tolerance / std::max(curvature, 1e-9));
    spacing = std::min(spacing, m_Parameters.maximumSpacing);
    for (std::size_t other = 0; other < m_Plans.size(); ++other)
    {
      if (other != c)
      {
        const double distance = DistanceToPolygon(plan.curve[i], m_Plans[other].given);
        spacing = std::min(spacing, m_Parameters.thinLayerRatio * distance);
      }
    }
    return plan.scale * std::max(spacing, m_Parameters.minimumSpacing);
  }

  void
  Sample(std::size_t c)
  {
    LoopPlan & plan = m_Plans[c];
    if (plan.keep)
    {
      plan.sampled = plan.given;
      return;
    }
    const std::size_t n = plan.curve.size();
    plan.target.resize(n);
    for (std::size_t i = 0; i < n; ++i)
    {
      plan.target[i] = this->TargetSpacing(c, i);
    }
    const std::vector<double> share = ShareAlong(plan);
    const int                 count = std::max(8, static_cast<int>(std::ceil(share.back() - 1e-9)));
    plan.sampled.clear();
    std::size_t i = 0;
    for (int k = 0; k < count; ++k)
    {
      const double wanted = share.back() * k / count;
      while (share[i + 1] <= wanted)
      {
        ++i;
      }
      const double fraction = (wanted - share[i]) / (share[i + 1] - share[i]);
      plan.sampled.push_back(plan.fit.curve.Evaluate((static_cast<double>(i) + fraction) / SamplesPerSpan));
    }
  }

  // Contours that cross, touch, or come nearer to another than the minimum distance and half of what was given.
  std::vector<int>
  FindConflicts() const
  {
    std::vector<int>         conflict(m_Plans.size(), 0);
    std::vector<PlanarChain> chains;
    for (const LoopPlan & plan : m_Plans)
    {
      chains.push_back({ plan.sampled, true });
    }
    const PlanarCrossing crossing = FindPlanarCrossing(chains);
    if (crossing.found)
    {
      conflict[crossing.chain[0]] = conflict[crossing.chain[1]] = 1;
    }
    for (std::size_t a = 0; a < m_Plans.size(); ++a)
    {
      for (std::size_t b = 0; b < m_Plans.size(); ++b)
      {
        if (a != b && this->ComeTooNear(m_Plans[a], m_Plans[b]))
        {
          conflict[a] = conflict[b] = 1;
        }
      }
    }
    return conflict;
  }

  bool
  ComeTooNear(const LoopPlan & a, const LoopPlan & b) const
  {
    return std::any_of(a.sampled.begin(), a.sampled.end(), [&](const Vector2 & q) {
      const double distance = DistanceToPolygon(q, b.sampled);
      return distance < m_Parameters.minimumDistance && distance < 0.5 * DistanceToPolygon(q, b.given);
    });
  }

  // False where nothing more can be done about the contour.
  bool
  Refine(LoopPlan & plan) const
  {
    if (plan.keep)
    {
      return false;
    }
    plan.scale *= 0.6;
    plan.keep = plan.scale < std::pow(0.6, MostRefinements + 0.5);
    if (!plan.keep)
    {
      this->Fit(plan);
    }
    return true;
  }

  const SamplingParameters & m_Parameters;
  SamplingReport &           m_Report;
  std::vector<LoopPlan>      m_Plans;
};
} // namespace

ContourSlice
SampleSlice(const ContourSlice &       slice,
            const ContourStack &       frame,
            const SamplingParameters & parameters,
            SamplingReport &           report)
{
  ContourSlice         result;
  std::vector<Polygon> given;
  result.origin = slice.origin;
  for (const Contour & contour : slice.contours)
  {
    if (!contour.axis)
    {
      result.contours.push_back(contour);
      given.emplace_back();
      for (const Vector3 & point : contour.points)
      {
        given.back().push_back(frame.ToPlane(point));
      }
    }
  }
  const double               height = slice.origin.dot(frame.GetNormal());
  const std::vector<Polygon> sampled = SliceSampler(std::move(given), parameters, report).Run();
  for (std::size_t c = 0; c < sampled.size(); ++c)
  {
    result.contours[c].points.clear();
    for (const Vector2 & q : sampled[c])
    {
      result.contours[c].points.push_back(frame.FromPlane(q, height));
    }
  }
  return result;
}
} // namespace bone
