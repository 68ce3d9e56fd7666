/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRingTriangulation.h"

#include "bonePredicates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bone
{
namespace tiling
{
namespace
{
constexpr int    NumberOfStarts = 8;
constexpr double Tie = 1e-9; ///< of the cost

/** Cost of one triangle: its new span and a share of its circumradius, infinite where it is not counter-clockwise. */
double
TriangleCost(const Vector2 & a, const Vector2 & b, const Vector2 & c, double span)
{
  if (Orient2D(a, b, c) <= 0)
  {
    return Infinity;
  }
  const double twiceArea = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  const double edges = (b - a).norm() * (c - b).norm() * (a - c).norm();
  // A triangle so flat that rounding in space could turn it over is no triangle.
  const double longest = std::max({ (b - a).norm(), (c - b).norm(), (a - c).norm() });
  if (twiceArea < 1e-6 * longest * longest)
  {
    return Infinity;
  }
  return span + 0.25 * edges / (2.0 * twiceArea);
}

struct RingProblem
{
  const std::vector<Vector2> & plane;
  const Walk &                 outer;
  const Walk &                 inner;

  const Vector2 &
  A(int i) const
  {
    return plane[outer[i % outer.size()]];
  }
  const Vector2 &
  B(int j) const
  {
    return plane[inner[j % inner.size()]];
  }
};

/** Cheapest ring that starts and ends at the spanning edge (a0, b0); infinite where there is none. */
double
SolveRing(const RingProblem & problem, int a0, int b0, std::vector<std::uint8_t> & letters)
{
  const int                 na = WalkSteps(problem.outer), nb = WalkSteps(problem.inner);
  const int                 stride = nb + 1;
  std::vector<double>       cost(static_cast<std::size_t>(na + 1) * stride, Infinity);
  std::vector<std::uint8_t> from(cost.size(), 2);
  cost[0] = 0.0;
  for (int i = 0; i <= na; ++i)
  {
    for (int j = 0; j <= nb; ++j)
    {
      const double here = cost[static_cast<std::size_t>(i) * stride + j];
      if (here == Infinity)
      {
        continue;
      }
      const Vector2 & a = problem.A(a0 + i);
      const Vector2 & b = problem.B(b0 + j);
      if (i < na)
      {
        const Vector2 & next = problem.A(a0 + i + 1);
        const double    c = here + TriangleCost(a, next, b, (next - b).norm());
        auto            to = static_cast<std::size_t>(i + 1) * stride + j;
        if (c < cost[to])
        {
          cost[to] = c;
          from[to] = 0;
        }
      }
      if (j < nb)
      {
        const Vector2 & next = problem.B(b0 + j + 1);
        const double    c = here + TriangleCost(a, next, b, (next - a).norm());
        auto            to = static_cast<std::size_t>(i) * stride + j + 1;
        if (c < cost[to])
        {
          cost[to] = c;
          from[to] = 1;
        }
      }
    }
  }
  const double total = cost.back();
  if (total < Infinity)
  {
    letters.clear();
    for (int i = na, j = nb; i > 0 || j > 0;)
    {
      const std::uint8_t letter = from[static_cast<std::size_t>(i) * stride + j];
      letters.push_back(letter);
      (letter == 0 ? i : j) -= 1;
    }
    std::reverse(letters.begin(), letters.end());
  }
  return total;
}
} // namespace

double
TriangulateRing(const std::vector<Vector2> & plane, const Walk & outer, const Walk & inner, Merge & ring)
{
  const RingProblem problem{ plane, outer, inner };
  const int         nb = static_cast<int>(inner.size());
  const int         starts = std::min(nb, NumberOfStarts);
  double            best = Infinity;
  int               found = 0;
  for (int s = 0; s < starts && found < 3; ++s)
  {
    const int b0 = static_cast<int>(static_cast<long>(s) * nb / starts);
    int       a0 = 0;
    for (int i = 1; i < static_cast<int>(outer.size()); ++i)
    {
      if ((problem.A(i) - problem.B(b0)).squaredNorm() < (problem.A(a0) - problem.B(b0)).squaredNorm())
      {
        a0 = i;
      }
    }
    std::vector<std::uint8_t> letters;
    const double              cost = SolveRing(problem, a0, b0, letters);
    if (cost < Infinity)
    {
      ++found;
    }
    // Sums of the same triangles from another start differ by rounding.
    if (cost < best - Tie * std::abs(cost))
    {
      best = cost;
      ring = Merge{ a0, b0, std::move(letters) };
    }
  }
  return best / std::max<double>(1.0, WalkSteps(outer) + WalkSteps(inner));
}

Merge
DegenerateRing(const Walk & walk)
{
  Merge ring;
  for (int i = 0; i < WalkSteps(walk); ++i)
  {
    ring.letters.push_back(0);
    ring.letters.push_back(1);
  }
  return ring;
}

std::vector<PlanarTriangle>
SectionTriangles(const Section & section)
{
  std::vector<PlanarTriangle> triangles = section.patch;
  for (std::size_t k = 0; k < section.rings.size(); ++k)
  {
    const Walk & outer = section.walks[k];
    const Walk & inner = section.inner[k];
    int          i = section.rings[k].first, j = section.rings[k].second;
    for (std::uint8_t letter : section.rings[k].letters)
    {
      const int a = outer[i % outer.size()], b = inner[j % inner.size()];
      const int next = letter == 0 ? outer[++i % outer.size()] : inner[++j % inner.size()];
      if (next != a && next != b && a != b)
      {
        triangles.push_back({ { a, next, b }, RegionOfSlot(section.region[k]) });
      }
    }
  }
  return triangles;
}
} // namespace tiling
} // namespace bone
