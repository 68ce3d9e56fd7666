/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionBuilder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace bone
{
namespace tiling
{
namespace
{
using Polygon = std::vector<Vector2>;

constexpr double MinimumOverlap = 0.15;     // of the smaller piece's area
constexpr double ReachInSlabHeights = 0.75; // a piece that overlaps none belongs to one nearer than this
constexpr int    OverlapSamples = 24;       // grid points a side

double
Separation(const Polygon & p, const Polygon & q)
{
  double best = std::numeric_limits<double>::infinity();
  for (const Vector2 & a : p)
  {
    for (const Vector2 & b : q)
    {
      best = std::min(best, (a - b).norm());
    }
  }
  return best;
}

/** Common area over the smaller area of two polygons, by sampling. */
double
Overlap(const std::vector<Vector2> & p, const std::vector<Vector2> & q)
{
  const auto boxOf = [](const std::vector<Vector2> & polygon) {
    std::pair<Vector2, Vector2> box(polygon.front(), polygon.front());
    for (const Vector2 & x : polygon)
    {
      box.first = box.first.cwiseMin(x);
      box.second = box.second.cwiseMax(x);
    }
    return box;
  };
  const auto    bp = boxOf(p), bq = boxOf(q);
  const Vector2 low = bp.first.cwiseMax(bq.first), high = bp.second.cwiseMin(bq.second);
  if ((high - low).minCoeff() <= 0)
  {
    return 0.0;
  }
  int both = 0;
  for (int i = 0; i < OverlapSamples; ++i)
  {
    for (int j = 0; j < OverlapSamples; ++j)
    {
      const Vector2 x = low + Vector2((i + 0.5) / OverlapSamples, (j + 0.5) / OverlapSamples).cwiseProduct(high - low);
      both += PointInPolygon(x, p) && PointInPolygon(x, q);
    }
  }
  const double common = both * (high - low).prod() / (OverlapSamples * OverlapSamples);
  return common / std::max(1e-12, std::min(std::abs(SignedArea(p)), std::abs(SignedArea(q))));
}

struct Link
{
  int    lower, upper;
  double score;
};

/** Drops the weakest links until no group has several pieces on both sides. */
void
KeepStars(std::vector<Link> & links, std::size_t nl, std::size_t nu)
{
  std::vector<int> degreeL(nl, 0), degreeU(nu, 0);
  for (const Link & link : links)
  {
    ++degreeL[link.lower];
    ++degreeU[link.upper];
  }
  std::stable_sort(links.begin(), links.end(), [](const Link & a, const Link & b) { return a.score < b.score; });
  std::vector<Link> kept;
  for (const Link & link : links)
  {
    if (degreeL[link.lower] > 1 && degreeU[link.upper] > 1)
    {
      --degreeL[link.lower];
      --degreeU[link.upper];
    }
    else
    {
      kept.push_back(link);
    }
  }
  links = std::move(kept);
}

/** Links a piece that overlaps nothing to the nearest piece of the other slice within reach. */
void
LinkByDistance(const std::vector<Polygon> & lower,
               const std::vector<Polygon> & upper,
               double                       reach,
               std::vector<Link> &          links)
{
  std::vector<char> linkedL(lower.size(), 0), linkedU(upper.size(), 0);
  for (const Link & link : links)
  {
    linkedL[link.lower] = linkedU[link.upper] = 1;
  }
  for (std::size_t i = 0; i < lower.size(); ++i)
  {
    for (std::size_t j = 0; j < upper.size(); ++j)
    {
      if (linkedL[i] && linkedU[j])
      {
        continue;
      }
      const double distance = Separation(lower[i], upper[j]);
      if (distance < reach)
      {
        links.push_back({ static_cast<int>(i), static_cast<int>(j), -distance });
      }
    }
  }
}
} // namespace

std::vector<Group>
MatchPieces(const std::vector<Polygon> & lower, const std::vector<Polygon> & upper, double slabHeight)
{
  std::vector<Link> links;
  for (std::size_t i = 0; i < lower.size(); ++i)
  {
    for (std::size_t j = 0; j < upper.size(); ++j)
    {
      const double score = Overlap(lower[i], upper[j]);
      if (score > MinimumOverlap)
      {
        links.push_back({ static_cast<int>(i), static_cast<int>(j), score });
      }
    }
  }
  LinkByDistance(lower, upper, ReachInSlabHeights * slabHeight, links);
  KeepStars(links, lower.size(), upper.size());
  // Each group is named by its single piece; stars need no general component search.
  std::vector<Group> groups;
  std::vector<int>   groupL(lower.size(), -1), groupU(upper.size(), -1);
  std::stable_sort(links.begin(), links.end(), [](const Link & a, const Link & b) {
    return std::tie(a.lower, a.upper) < std::tie(b.lower, b.upper);
  });
  for (const Link & link : links)
  {
    int & gl = groupL[link.lower];
    int & gu = groupU[link.upper];
    if (gl < 0 && gu < 0)
    {
      gl = gu = static_cast<int>(groups.size());
      groups.push_back({ { link.lower }, { link.upper } });
    }
    else if (gl < 0)
    {
      gl = gu;
      groups[gu].lower.push_back(link.lower);
    }
    else if (gu < 0)
    {
      gu = gl;
      groups[gl].upper.push_back(link.upper);
    }
  }
  for (std::size_t i = 0; i < lower.size(); ++i)
  {
    if (groupL[i] < 0)
    {
      groups.push_back({ { static_cast<int>(i) }, {} });
    }
  }
  for (std::size_t j = 0; j < upper.size(); ++j)
  {
    if (groupU[j] < 0)
    {
      groups.push_back({ {}, { static_cast<int>(j) } });
    }
  }
  return groups;
}
} // namespace tiling
} // namespace bone
