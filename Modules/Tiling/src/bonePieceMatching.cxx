/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionBuilder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

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

using Link = std::array<int, 2>; ///< a lower and an upper piece

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
    linkedL[link[0]] = linkedU[link[1]] = 1;
  }
  for (std::size_t i = 0; i < lower.size(); ++i)
  {
    for (std::size_t j = 0; j < upper.size(); ++j)
    {
      if (linkedL[i] && linkedU[j])
      {
        continue;
      }
      if (Separation(lower[i], upper[j]) < reach)
      {
        links.push_back({ { static_cast<int>(i), static_cast<int>(j) } });
      }
    }
  }
}
} // namespace

std::vector<Group>
MatchPieces(const std::vector<Polygon> & lower, const std::vector<Polygon> & upper, double slabHeight)
{
  const int         nl = static_cast<int>(lower.size()), nu = static_cast<int>(upper.size());
  std::vector<Link> links;
  for (int i = 0; i < nl; ++i)
  {
    for (int j = 0; j < nu; ++j)
    {
      if (Overlap(lower[i], upper[j]) > MinimumOverlap)
      {
        links.push_back({ { i, j } });
      }
    }
  }
  LinkByDistance(lower, upper, ReachInSlabHeights * slabHeight, links);
  std::vector<int> root(nl + nu);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&root](int i) {
    while (root[i] != i)
    {
      i = root[i] = root[root[i]];
    }
    return i;
  };
  for (const Link & link : links)
  {
    root[find(nl + link[1])] = find(link[0]);
  }
  std::vector<Group> groups;
  std::vector<int>   groupOf(nl + nu, -1);
  for (int i = 0; i < nl + nu; ++i)
  {
    int & group = groupOf[find(i)];
    if (group < 0)
    {
      group = static_cast<int>(groups.size());
      groups.emplace_back();
    }
    (i < nl ? groups[group].lower : groups[group].upper).push_back(i < nl ? i : i - nl);
  }
  return groups;
}
} // namespace tiling
} // namespace bone
