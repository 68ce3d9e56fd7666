/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourSampling.h"

#include "boneContourStack.h"
#include "boneLayerDistance.h"
#include "boneMedialAxis.h"
#include "bonePlanarCrossing.h"
#include "boneSparseCholesky.h"

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
constexpr double ChordFactor = 12.0; // a chord of length s on curvature k rises by k s^2 / 8, of which 2/3 lie outside
constexpr int    MostRefinements = 4;
constexpr int    MostFailures = 1; // of a pair whose contours given are apart, before they may come nearer

struct LoopPlan
{
  Polygon              given;
  BSplineFit           fit;
  double               scale{ 1.0 }; // of spacing and tolerance
  bool                 keep{ false };
  int                  layer{ 0 };
  bool                 hole{ false };
  Polygon              sampled;
  std::vector<Vector2> curve;  // fine points on the spline
  std::vector<double>  target; // spacing wanted there
};

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

// The closed polygon nearest to a curve in the mean square, corner k standing at position at[k] along the curve's fine
// points: chords then pass the curve on both sides, and the polygon keeps its area.
Polygon
FitChords(const std::vector<Vector2> & curve, const std::vector<double> & at)
{
  const auto               n = static_cast<Eigen::Index>(at.size());
  const std::size_t        m = curve.size();
  std::vector<SparseEntry> entries;
  Eigen::MatrixX2d         right = Eigen::MatrixX2d::Zero(n, 2);
  const auto               point = [&](double s) {
    const double whole = std::floor(s);
    const auto   i = static_cast<std::size_t>(whole) % m;
    return Vector2(curve[i] + (s - whole) * (curve[(i + 1) % m] - curve[i]));
  };
  for (Eigen::Index k = 0; k < n; ++k)
  {
    const Eigen::Index   next = (k + 1) % n;
    const double         begin = at[static_cast<std::size_t>(k)];
    const double         end = next > 0 ? at[static_cast<std::size_t>(next)] : at[0] + static_cast<double>(m);
    std::vector<Vector2> piece{ point(begin) };
    for (double s = std::floor(begin) + 1.0; s < end; s += 1.0)
    {
      piece.push_back(point(s));
    }
    piece.push_back(point(end));
    std::vector<double> along{ 0.0 };
    for (std::size_t i = 1; i < piece.size(); ++i)
    {
      along.push_back(along.back() + (piece[i] - piece[i - 1]).norm());
    }
    for (std::size_t i = 1; i < piece.size() && along.back() > 0.0; ++i)
    {
      // Simpson's rule, exact: the integrands are of second degree.
      for (int node = 0; node < 3; ++node)
      {
        const double  share = 0.5 * node;
        const double  weight = (along[i] - along[i - 1]) * (node == 1 ? 4.0 : 1.0) / 6.0;
        const double  t = ((1.0 - share) * along[i - 1] + share * along[i]) / along.back();
        const Vector2 q = (1.0 - share) * piece[i - 1] + share * piece[i];
        entries.push_back({ k, k, weight * (1.0 - t) * (1.0 - t) });
        entries.push_back({ k, next, weight * t * (1.0 - t) });
        entries.push_back({ next, k, weight * t * (1.0 - t) });
        entries.push_back({ next, next, weight * t * t });
        right.row(k) += weight * (1.0 - t) * q.transpose();
        right.row(next) += weight * t * q.transpose();
      }
    }
  }
  SparseCholesky factor;
  factor.Factorize(n, entries);
  const Eigen::MatrixXd corners = factor.Solve(right);
  Polygon               polygon;
  for (Eigen::Index k = 0; k < n; ++k)
  {
    polygon.emplace_back(corners.row(k).transpose());
  }
  return polygon;
}

class SliceSampler
{
public:
  SliceSampler(std::vector<LoopPlan>             plans,
               const ContourResampleParameters & parameters,
               double                            spacingScale,
               SamplingReport &                  report)
    : m_Parameters(parameters)
    , m_SpacingScale(spacingScale)
    , m_Report(report)
    , m_Plans(std::move(plans))
  {
    for (const LoopPlan & plan : m_Plans)
    {
      m_ToGiven.emplace_back(plan.given);
    }
    this->FindNeighbours();
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
      const std::vector<char> apart = this->MoveApart();
      dirty = this->FindConflicts();
      for (std::size_t p = 0; p < m_Pairs.size(); ++p)
      {
        if (apart[p] == 0)
        {
          dirty[m_Pairs[p].inner] = dirty[m_Pairs[p].fixed] = 1;
        }
      }
      again = false;
      for (std::size_t c = 0; c < m_Plans.size(); ++c)
      {
        dirty[c] = dirty[c] != 0 && this->Refine(m_Plans[c]);
        again = again || dirty[c] != 0;
      }
    }
    m_Report.near += static_cast<int>(std::count_if(m_Pairs.begin(), m_Pairs.end(), [this](const Pair & pair) {
      return pair.gap < m_Parameters.minimumLayerDistance;
    }));
    std::vector<Polygon> result;
    for (LoopPlan & plan : m_Plans)
    {
      m_Report.samples += static_cast<int>(plan.sampled.size());
      m_Report.refined += plan.scale < 1.0;
      m_Report.unfitted += plan.keep;
      m_Report.largestError = plan.keep ? m_Report.largestError : std::max(m_Report.largestError, plan.fit.deviation);
      result.push_back(std::move(plan.sampled));
    }
    return result;
  }

private:
  // An inner contour and one that it must keep away from: the one around it, a hole beside it, or an earlier contour of
  // its layer beside it.
  struct Pair
  {
    std::size_t inner;
    std::size_t fixed;
    bool        inside; // of the fixed one
    double      gap;
    int         failures{ 0 };
  };

  // Pairs from the outside in.
  void
  FindNeighbours()
  {
    std::vector<Polygon> given;
    for (const LoopPlan & plan : m_Plans)
    {
      given.push_back(plan.given);
    }
    const std::vector<int> around = FindPolygonsAround(given);
    for (std::size_t c = 0; c < m_Plans.size(); ++c)
    {
      for (std::size_t other = 0; other < m_Plans.size(); ++other)
      {
        const bool inside = around[c] == static_cast<int>(other) && !m_Plans[other].hole;
        const bool beside = around[c] >= 0 && around[c] == around[other] && (m_Plans[other].hole || other < c);
        if (other == c || m_Plans[c].hole || m_Plans[c].layer == 0 || (!inside && !beside))
        {
          continue;
        }
        m_Pairs.push_back({ c, other, inside, m_Parameters.minimumLayerDistance, 0 });
      }
    }
    std::stable_sort(m_Pairs.begin(), m_Pairs.end(), [this](const Pair & a, const Pair & b) {
      return m_Plans[a.inner].layer < m_Plans[b.inner].layer;
    });
  }

  // Whether each pair keeps its distance; a contour with several goes round them a few times. A pair that cannot,
  // though sampled more finely if the contours given keep theirs, shall from then on keep nearly what those do.
  std::vector<char>
  MoveApart()
  {
    std::vector<char> apart(m_Pairs.size(), 1);
    for (int round = 0; round < 4; ++round)
    {
      int moved = 0;
      for (std::size_t p = 0; p < m_Pairs.size(); ++p)
      {
        const int moves = this->Separate(m_Pairs[p]);
        apart[p] = moves >= 0 ? 1 : 0;
        moved += std::max(moves, 0);
      }
      m_Report.moved += moved;
      if (moved == 0)
      {
        break;
      }
    }
    for (std::size_t p = 0; p < m_Pairs.size(); ++p)
    {
      if (apart[p] == 0)
      {
        Pair &       pair = m_Pairs[p];
        const double given = DistanceBetween(m_Plans[pair.inner].given, m_Plans[pair.fixed].given);
        if (given < pair.gap || ++pair.failures > MostFailures)
        {
          pair.gap = std::min(pair.gap, 0.9 * given);
        }
      }
    }
    return apart;
  }

  // Number of moves, -1: the pair remains too near.
  int
  Separate(const Pair & pair)
  {
    LoopPlan &       inner = m_Plans[pair.inner];
    const LoopPlan & fixed = m_Plans[pair.fixed];
    if (!inner.keep)
    {
      return MoveAway(inner.sampled, fixed.sampled, pair.inside, pair.gap);
    }
    return fixed.keep || DistanceBetween(inner.sampled, fixed.sampled) >= 0.5 * pair.gap ? 0 : -1;
  }

  void
  Fit(LoopPlan & plan) const
  {
    const double length = Perimeter(plan.given);
    const double longest = std::max(0.25 * m_Parameters.maximumSpacing * plan.scale, length / 2000.0);
    Polygon      points = SplitEdges(plan.given, std::min(longest, length / 16.0));
    plan.fit = FitClosedBSplineWithin(points, this->Tolerance(plan) * plan.scale);
    const auto m = plan.fit.curve.GetNumberOfControlPoints();
    plan.curve.clear();
    for (std::size_t i = 0; i < SamplesPerSpan * m; ++i)
    {
      plan.curve.push_back(plan.fit.curve.Evaluate(static_cast<double>(i) / SamplesPerSpan));
    }
  }

  double
  Tolerance(const LoopPlan & plan) const
  {
    return m_Parameters.tolerance * (plan.layer > 0 ? m_Parameters.innerToleranceFactor : 1.0);
  }

  double
  TargetSpacing(std::size_t c, std::size_t i) const
  {
    const LoopPlan & plan = m_Plans[c];
    const double     curvature = std::abs(plan.fit.curve.Curvature(static_cast<double>(i) / SamplesPerSpan));
    double           spacing = std::sqrt(ChordFactor * this->Tolerance(plan) / std::max(curvature, 1e-9));
    spacing = std::min(spacing, m_Parameters.maximumSpacing);
    for (std::size_t other = 0; other < m_Plans.size(); ++other)
    {
      if (other != c)
      {
        const double distance = m_ToGiven[other](plan.curve[i]).distance;
        spacing = std::min(spacing, m_Parameters.thinLayerRatio * distance);
      }
    }
    return plan.scale * m_SpacingScale * std::max(spacing, m_Parameters.minimumSpacing);
  }

  // Positions on the contour given that are nearest to those on the curve; none where they are not in order.
  std::vector<double>
  OnGiven(std::size_t c, const std::vector<double> & at) const
  {
    const LoopPlan &    plan = m_Plans[c];
    const auto          size = static_cast<double>(plan.given.size());
    std::vector<double> onGiven;
    double              turned = 0.0;
    for (const double s : at)
    {
      const auto found = m_ToGiven[c](plan.fit.curve.Evaluate(s / SamplesPerSpan));
      double     position = static_cast<double>(found.edge) + found.along + turned;
      if (!onGiven.empty() && position <= onGiven.back() && turned == 0.0)
      {
        turned = size;
        position += size;
      }
      if (!onGiven.empty() && (position <= onGiven.back() || position >= onGiven.front() + size))
      {
        return {};
      }
      onGiven.push_back(position);
    }
    return onGiven;
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
    std::vector<double>       at;
    std::size_t               i = 0;
    for (int k = 0; k < count; ++k)
    {
      const double wanted = share.back() * k / count;
      while (share[i + 1] <= wanted)
      {
        ++i;
      }
      const double fraction = (wanted - share[i]) / (share[i + 1] - share[i]);
      at.push_back(static_cast<double>(i) + fraction);
    }
    const std::vector<double> onGiven = this->OnGiven(c, at);
    plan.sampled = onGiven.empty() ? FitChords(plan.curve, at) : FitChords(plan.given, onGiven);
  }

  // Contours that cross, touch, or come too near to another.
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
        if (a != b && this->ComeTooNear(a, b))
        {
          conflict[a] = conflict[b] = 1;
        }
      }
    }
    return conflict;
  }

  // Contours that are no pair, such as two pieces of bone, keep half of the minimum distance or of what they had.
  bool
  ComeTooNear(std::size_t a, std::size_t b) const
  {
    if (std::any_of(m_Pairs.begin(), m_Pairs.end(), [a, b](const Pair & pair) {
          return (pair.inner == a && pair.fixed == b) || (pair.inner == b && pair.fixed == a);
        }))
    {
      return false;
    }
    const NearestOnPolygon toSampled(m_Plans[b].sampled);
    return std::any_of(m_Plans[a].sampled.begin(), m_Plans[a].sampled.end(), [&](const Vector2 & q) {
      const double distance = toSampled(q).distance;
      return distance < 0.5 * m_Parameters.minimumLayerDistance && distance < 0.5 * m_ToGiven[b](q).distance;
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

  const ContourResampleParameters & m_Parameters;
  double                            m_SpacingScale;
  SamplingReport &                  m_Report;
  std::vector<LoopPlan>             m_Plans;
  std::vector<NearestOnPolygon>     m_ToGiven; // in the order of the plans
  std::vector<Pair>                 m_Pairs;
};
} // namespace

ContourSlice
SampleSlice(const ContourSlice &              slice,
            const ContourStack &              frame,
            const ContourResampleParameters & parameters,
            double                            spacingScale,
            SamplingReport &                  report)
{
  ContourSlice          result;
  std::vector<LoopPlan> plans;
  result.origin = slice.origin;
  for (const Contour & contour : slice.contours)
  {
    if (!contour.axis)
    {
      result.contours.push_back(contour);
      plans.emplace_back();
      plans.back().layer = contour.layer;
      plans.back().hole = contour.region == Region::Outside;
      for (const Vector3 & point : contour.points)
      {
        plans.back().given.push_back(frame.ToPlane(point));
      }
    }
  }
  const double               height = slice.origin.dot(frame.GetNormal());
  const std::vector<Polygon> sampled = SliceSampler(std::move(plans), parameters, spacingScale, report).Run();
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

std::size_t
CountSamples(const ContourStack & stack)
{
  std::size_t count = 0;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    for (const Contour & contour : slice.contours)
    {
      count += contour.axis ? 0 : contour.points.size();
    }
  }
  return count;
}

double
EstimateTetrahedra(const ContourStack & stack)
{
  // Fitted to tilings of seven real bones at spacings of 4 to 7 mm; each came out within 27 %.
  constexpr double perRing = 1.54;
  constexpr double perInnermost = 1.79;
  double           sum = 0.0;
  const auto       n = stack.GetSlices().size();
  for (std::size_t k = 0; k < n; ++k)
  {
    const double                 slabs = (k > 0 ? 1.0 : 0.0) + (k + 1 < n ? 1.0 : 0.0);
    std::vector<Polygon>         polygons;
    std::vector<const Contour *> contours;
    for (const Contour & contour : stack.GetSlices()[k].contours)
    {
      if (!contour.axis)
      {
        contours.push_back(&contour);
        polygons.emplace_back();
        for (const Vector3 & point : contour.points)
        {
          polygons.back().push_back(stack.ToPlane(point));
        }
      }
    }
    std::vector<char> innermost(polygons.size(), 1);
    const auto        around = FindPolygonsAround(polygons);
    for (std::size_t c = 0; c < polygons.size(); ++c)
    {
      if (around[c] >= 0 && contours[c]->region != Region::Outside)
      {
        innermost[static_cast<std::size_t>(around[c])] = 0;
      }
    }
    for (std::size_t c = 0; c < polygons.size(); ++c)
    {
      const bool   axis = innermost[c] != 0 && contours[c]->region != Region::Outside;
      const double weight = perRing * (contours[c]->layer == 0 ? 1.0 : 2.0) + (axis ? perInnermost : 0.0);
      sum += slabs * weight * static_cast<double>(polygons[c].size());
    }
  }
  return sum;
}
} // namespace bone
