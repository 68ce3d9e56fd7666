/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRingKnit.h"

#include "boneMeshArrays.h"
#include "bonePredicates.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace tiling
{
namespace
{
constexpr int    NumberOfKnits = 6;
constexpr double DepartureWeight = 10.0; // of a mm of the wall's departure against a mm of span

/** The diagonal that cuts the quadrilateral between two spanning edges. */
enum Diagonal : int
{
  InnerUpper = 0, ///< from the outer contour below to the inner one above
  InnerLower = 1  ///< from the inner contour below to the outer one above
};

/** What a step does: advances below or above, or changes the diagonal. */
enum Move : std::uint8_t
{
  AdvanceLower = 0,
  AdvanceUpper = 1,
  ChangeDiagonal = 2,
  NoMove = 3
};

/** A ring's word unrolled from a start: vertices and walk positions of each spanning edge. */
struct Word
{
  std::vector<int>          a, b;         ///< vertex ids at state i, one more than letters
  std::vector<int>          outer, inner; ///< steps made on the outer and inner walk up to state i
  std::vector<std::uint8_t> letters;
};

/** The ring's word from the state whose inner position (mod length) is `innerPosition`, `skip` states later. */
Word
Unroll(const Walk & outerWalk, const Walk & innerWalk, const Merge & ring, int state)
{
  const int n = static_cast<int>(ring.letters.size());
  int       i = ring.first, j = ring.second;
  for (int s = 0; s < state; ++s)
  {
    (ring.letters[s] == 0 ? i : j) += 1;
  }
  Word word;
  word.outer.push_back(i);
  word.inner.push_back(j);
  for (int s = 0; s < n; ++s)
  {
    const std::uint8_t letter = ring.letters[(state + s) % n];
    word.letters.push_back(letter);
    (letter == 0 ? i : j) += 1;
    word.outer.push_back(i);
    word.inner.push_back(j);
  }
  for (int s = 0; s <= n; ++s)
  {
    word.a.push_back(outerWalk[word.outer[s] % outerWalk.size()]);
    word.b.push_back(innerWalk[word.inner[s] % innerWalk.size()]);
  }
  return word;
}

/** States of a ring's word (0..n-1) at which the inner walk stands at `position`. */
std::vector<int>
StatesAt(const Walk & innerWalk, const Merge & ring, int position)
{
  const int        size = static_cast<int>(innerWalk.size());
  const int        n = static_cast<int>(ring.letters.size());
  std::vector<int> states;
  int              j = ring.second;
  for (int s = 0; s < std::max(n, 1); ++s)
  {
    if ((j - position) % size == 0)
    {
      states.push_back(s);
    }
    if (s < n && ring.letters[s] == 1)
    {
      ++j;
    }
  }
  return states;
}

bool
Distinct(const Id4 & t)
{
  return t[0] != t[1] && t[0] != t[2] && t[0] != t[3] && t[1] != t[2] && t[1] != t[3] && t[2] != t[3];
}

/** The at most two tetrahedra of a move from state (i, j). */
int
StepTetrahedra(const Word & lower, const Word & upper, int i, int j, int move, int diagonal, std::array<Id4, 2> & out)
{
  const int  a = lower.a[i], b = lower.b[i], c = upper.a[j], d = upper.b[j];
  int        n = 0;
  const auto add = [&](int v0, int v1, int v2, int v3) {
    const Id4 t{ { v0, v1, v2, v3 } };
    if (Distinct(t))
    {
      out[n++] = t;
    }
  };
  const bool innerUpper = diagonal == InnerUpper;
  if (move == ChangeDiagonal)
  {
    innerUpper ? add(a, b, d, c) : add(a, b, c, d);
  }
  else if (move == AdvanceLower && lower.letters[i] == 0)
  {
    const int a2 = lower.a[i + 1];
    if (innerUpper)
    {
      add(a, a2, b, d);
      add(a, a2, d, c);
    }
    else
    {
      add(a, a2, b, c);
    }
  }
  else if (move == AdvanceLower)
  {
    const int b2 = lower.b[i + 1];
    if (innerUpper)
    {
      add(a, b2, b, d);
    }
    else
    {
      add(a, b2, b, c);
      add(b, b2, d, c);
    }
  }
  else if (upper.letters[j] == 0)
  {
    const int c2 = upper.a[j + 1];
    if (innerUpper)
    {
      add(a, c, c2, d);
    }
    else
    {
      add(a, b, c, c2);
      add(b, c, c2, d);
    }
  }
  else
  {
    const int d2 = upper.b[j + 1];
    if (innerUpper)
    {
      add(a, c, d2, d);
      add(a, b, d, d2);
    }
    else
    {
      add(b, c, d2, d);
    }
  }
  return n;
}

class Knit
{
public:
  Knit(const VertexPool &   pool,
       const TilingMetric & metric,
       const WallGuide &    guide,
       const Word &         lower,
       const Word &         upper)
    : m_Pool(pool)
    , m_Metric(metric)
    , m_Guide(guide)
    , m_Lower(lower)
    , m_Upper(upper)
  {}

  /** Cost of a move from state (i, j); infinite where a tetrahedron would not be positive. */
  double
  Cost(int i, int j, int diagonal, int move) const
  {
    std::array<Id4, 2> tetrahedra;
    const int          n = StepTetrahedra(m_Lower, m_Upper, i, j, move, diagonal, tetrahedra);
    if (move == ChangeDiagonal && n == 0)
    {
      return Infinity; // no quadrilateral here: the two cuts are the same
    }
    TilingStep step;
    double     penalty = 0.0;
    for (int t = 0; t < n; ++t)
    {
      const Vector3 & p0 = P(tetrahedra[t][0]);
      const Vector3 & p1 = P(tetrahedra[t][1]);
      const Vector3 & p2 = P(tetrahedra[t][2]);
      const Vector3 & p3 = P(tetrahedra[t][3]);
      if (Orient3D(p0, p1, p2, p3) <= 0)
      {
        return Infinity;
      }
      const double volume = SignedVolume(p0, p1, p2, p3);
      const double scale = std::max({ (p1 - p0).squaredNorm(),
                                      (p2 - p0).squaredNorm(),
                                      (p3 - p0).squaredNorm(),
                                      (p2 - p1).squaredNorm(),
                                      (p3 - p1).squaredNorm(),
                                      (p3 - p2).squaredNorm() });
      const double size = std::sqrt(scale);
      const double flatness = volume / (scale * size);
      if (flatness < 1e-7)
      {
        return Infinity; // positive, but no longer surely so after rounding in a file or a small move
      }
      penalty += flatness < 1e-3 ? size : 0.0;
      step.volume += volume;
    }
    Describe(i, j, diagonal, move, step);
    if (move != ChangeDiagonal && OuterMoves(i, j, move))
    {
      penalty += DepartureWeight * DepartureAfter(i, j, move);
    }
    return m_Metric.Evaluate(step) + penalty;
  }

  /** Whether a move, no change of diagonal, advances an outer walk. */
  bool
  OuterMoves(int i, int j, int move) const
  {
    return (move == AdvanceLower ? m_Lower.letters[i] : m_Upper.letters[j]) == 0;
  }

  /** The departure of the wall's edge that such a move leads to. */
  double
  DepartureAfter(int i, int j, int move) const
  {
    return m_Guide.Departure(m_Lower.a[move == AdvanceLower ? i + 1 : i], m_Upper.a[move == AdvanceUpper ? j + 1 : j]);
  }

private:
  const Vector3 &
  P(int v) const
  {
    return m_Pool.space[v];
  }

  /** The cross-section that the move leads to: the edge that moved, the diagonal and the two faces. */
  void
  Describe(int i, int j, int diagonal, int move, TilingStep & step) const
  {
    const int  i2 = move == AdvanceLower ? i + 1 : i, j2 = move == AdvanceUpper ? j + 1 : j;
    const int  a = m_Lower.a[i2], b = m_Lower.b[i2], c = m_Upper.a[j2], d = m_Upper.b[j2];
    const bool innerUpper = (move == ChangeDiagonal ? 1 - diagonal : diagonal) == InnerUpper;
    const auto edge = [&](int u, int v) {
      step.edges[2 * step.numberOfEdges] = P(u);
      step.edges[2 * step.numberOfEdges + 1] = P(v);
      ++step.numberOfEdges;
    };
    const auto face = [&](int u, int v, int w) {
      step.faces[3 * step.numberOfFaces] = P(u);
      step.faces[3 * step.numberOfFaces + 1] = P(v);
      step.faces[3 * step.numberOfFaces + 2] = P(w);
      ++step.numberOfFaces;
    };
    // The diagonal counts at each move, new or not: else long runs on one side would be cheap.
    if (move != ChangeDiagonal)
    {
      OuterMoves(i, j, move) ? edge(a, c) : edge(b, d);
    }
    innerUpper ? edge(a, d) : edge(b, c);
    if (innerUpper)
    {
      face(a, b, d);
      face(a, d, c);
    }
    else
    {
      face(a, b, c);
      face(b, d, c);
    }
  }

  const VertexPool &   m_Pool;
  const TilingMetric & m_Metric;
  const WallGuide &    m_Guide;
  const Word &         m_Lower;
  const Word &         m_Upper;
};

/** For each number of steps on the lower inner walk the range of steps on the upper one that the inner wall passes. */
struct Corridor
{
  std::vector<int> lowest, highest;
};

Corridor
CorridorOf(const Merge & inner, int begin, int lowerSteps)
{
  Corridor  corridor;
  const int n = static_cast<int>(inner.letters.size());
  corridor.lowest.assign(static_cast<std::size_t>(lowerSteps) + 1, 0);
  corridor.highest.assign(static_cast<std::size_t>(lowerSteps) + 1, 0);
  int p = 0, q = 0;
  for (int m = 0; m < n; ++m)
  {
    if (inner.letters[(begin + m) % n] == 0)
    {
      corridor.highest[p] = q;
      corridor.lowest[++p] = q;
    }
    else
    {
      ++q;
    }
    corridor.highest[p] = q;
  }
  return corridor;
}

/** Row i of the table holds the states (i, j) with j in [begin, begin + cost.size()), for either diagonal. */
struct Row
{
  int                                      begin{ 0 };
  std::vector<std::array<double, 2>>       cost;
  std::vector<std::array<std::uint8_t, 2>> from;

  int
  End() const
  {
    return begin + static_cast<int>(cost.size());
  }
};

/** The dynamic programme over the states within the corridor. */
class Table
{
public:
  Table(const Word & lower, const Word & upper, const Corridor & corridor)
    : m_Lower(static_cast<int>(lower.letters.size()))
    , m_Upper(static_cast<int>(upper.letters.size()))
  {
    const int p0 = lower.inner[0], q0 = upper.inner[0];
    for (int i = 0; i <= m_Lower; ++i)
    {
      const int  p = lower.inner[i] - p0;
      const auto first = std::lower_bound(upper.inner.begin(), upper.inner.end(), q0 + corridor.lowest[p]);
      const auto last = std::upper_bound(upper.inner.begin(), upper.inner.end(), q0 + corridor.highest[p]);
      Row        row;
      row.begin = static_cast<int>(first - upper.inner.begin());
      row.cost.resize(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, last - first)), { Infinity, Infinity });
      row.from.resize(row.cost.size(), { NoMove, NoMove });
      m_Rows.push_back(std::move(row));
    }
  }

  /** Moves of the cheapest closed path that begins and ends with the given diagonal; `total` is infinite where there is
   * none. */
  std::vector<std::uint8_t>
  Solve(const Knit & knit, int diagonal, double & total)
  {
    for (Row & row : m_Rows)
    {
      std::fill(row.cost.begin(), row.cost.end(), std::array<double, 2>{ { Infinity, Infinity } });
    }
    m_Rows[0].cost[0][diagonal] = 0.0;
    for (int i = 0; i <= m_Lower; ++i)
    {
      for (int j = m_Rows[i].begin; j < m_Rows[i].End(); ++j)
      {
        Relax(knit, i, j);
      }
    }
    std::vector<std::uint8_t> path;
    const Row &               last = m_Rows[m_Lower];
    total = m_Upper >= last.begin && m_Upper < last.End() ? last.cost[m_Upper - last.begin][diagonal] : Infinity;
    for (int i = m_Lower, j = m_Upper, d = diagonal; total < Infinity && (i > 0 || j > 0 || d != diagonal);)
    {
      const std::uint8_t move = m_Rows[i].from[j - m_Rows[i].begin][d];
      path.push_back(move);
      i -= move == AdvanceLower;
      j -= move == AdvanceUpper;
      d = move == ChangeDiagonal ? 1 - d : d;
    }
    std::reverse(path.begin(), path.end());
    return path;
  }

private:
  void
  Improve(int i, int j, int d, double cost, std::uint8_t move)
  {
    Row & row = m_Rows[i];
    if (j >= row.begin && j < row.End() && cost < row.cost[j - row.begin][d])
    {
      row.cost[j - row.begin][d] = cost;
      row.from[j - row.begin][d] = move;
    }
  }

  void
  Relax(const Knit & knit, int i, int j)
  {
    const auto & cost = m_Rows[i].cost[j - m_Rows[i].begin];
    // Only one of the two changes of diagonal is positive, so their order does not matter.
    for (int d = 0; d < 2; ++d)
    {
      if (cost[d] < Infinity)
      {
        Improve(i, j, 1 - d, cost[d] + knit.Cost(i, j, d, ChangeDiagonal), ChangeDiagonal);
      }
    }
    for (int d = 0; d < 2; ++d)
    {
      if (cost[d] == Infinity)
      {
        continue;
      }
      if (j < m_Upper && j + 1 < m_Rows[i].End())
      {
        Improve(i, j + 1, d, cost[d] + knit.Cost(i, j, d, AdvanceUpper), AdvanceUpper);
      }
      if (i < m_Lower && j >= m_Rows[i + 1].begin && j < m_Rows[i + 1].End())
      {
        Improve(i + 1, j, d, cost[d] + knit.Cost(i, j, d, AdvanceLower), AdvanceLower);
      }
    }
  }

  int              m_Lower;
  int              m_Upper;
  std::vector<Row> m_Rows;
};

/** A way to begin: a state of the inner wall and one spanning edge at it on either slice. */
struct Start
{
  int    wall;
  int    lower;
  int    upper;
  double length;
};

std::vector<Start>
RankStarts(const VertexPool & pool, const RingPair & rings, const Merge & inner)
{
  const int          n = static_cast<int>(inner.letters.size());
  std::vector<Start> starts;
  const int          count = std::max(1, std::min(n, 4 * NumberOfKnits));
  int                p = inner.first, q = inner.second;
  for (int m = 0, taken = 0; m < std::max(n, 1); ++m)
  {
    if (static_cast<long>(taken) * std::max(n, 1) <= static_cast<long>(m) * count)
    {
      ++taken;
      Start best{ m, 0, 0, Infinity };
      for (int sl : StatesAt(rings.innerLower, rings.ringLower, p))
      {
        for (int su : StatesAt(rings.innerUpper, rings.ringUpper, q))
        {
          int il = rings.ringLower.first, iu = rings.ringUpper.first;
          for (int s = 0; s < sl; ++s)
          {
            il += rings.ringLower.letters[s] == 0;
          }
          for (int s = 0; s < su; ++s)
          {
            iu += rings.ringUpper.letters[s] == 0;
          }
          const double length = (pool.space[rings.outerLower[il % rings.outerLower.size()]] -
                                 pool.space[rings.outerUpper[iu % rings.outerUpper.size()]])
                                  .norm();
          if (length < best.length)
          {
            best = { m, sl, su, length };
          }
        }
      }
      if (best.length < Infinity)
      {
        starts.push_back(best);
      }
    }
    if (m < n)
    {
      (inner.letters[m] == 0 ? p : q) += 1;
    }
  }
  std::stable_sort(starts.begin(), starts.end(), [](const Start & a, const Start & b) { return a.length < b.length; });
  return starts;
}
} // namespace

RingKnit
KnitRing(const VertexPool &        pool,
         const RingPair &          rings,
         const Merge &             inner,
         const TilingMetric &      metric,
         const WallGuide &         guide,
         int                       start,
         int                       region,
         Merge &                   outer,
         std::vector<TiledTetra> & tetrahedra)
{
  const auto starts = RankStarts(pool, rings, inner);
  const int  usable = std::min<int>(static_cast<int>(starts.size()), NumberOfKnits);
  RingKnit   result;
  result.moreStarts = start + 1 < usable;
  if (start >= usable)
  {
    return result;
  }
  // The best starts may be neighbours on the ring; spread the choice over the ranking.
  const Start &  chosen = starts[static_cast<std::size_t>(start) * starts.size() / usable];
  const Word     lower = Unroll(rings.outerLower, rings.innerLower, rings.ringLower, chosen.lower);
  const Word     upper = Unroll(rings.outerUpper, rings.innerUpper, rings.ringUpper, chosen.upper);
  const Corridor corridor = CorridorOf(inner, chosen.wall, WalkSteps(rings.innerLower));
  const Knit     knit(pool, metric, guide, lower, upper);
  Table          table(lower, upper, corridor);
  double         cost = Infinity, otherCost = Infinity;
  auto           path = table.Solve(knit, InnerUpper, cost);
  const auto     otherPath = table.Solve(knit, InnerLower, otherCost);
  int            diagonal = otherCost < cost ? InnerLower : InnerUpper;
  if (std::min(cost, otherCost) == Infinity)
  {
    return result;
  }
  result.made = true;
  if (diagonal == InnerLower)
  {
    path = otherPath;
  }
  outer = Merge{};
  outer.first = lower.outer[0] % static_cast<int>(rings.outerLower.size());
  outer.second = upper.outer[0] % static_cast<int>(rings.outerUpper.size());
  int i = 0, j = 0;
  for (std::uint8_t move : path)
  {
    std::array<Id4, 2> cells;
    const int          n = StepTetrahedra(lower, upper, i, j, move, diagonal, cells);
    for (int t = 0; t < n; ++t)
    {
      tetrahedra.push_back({ cells[t], region });
    }
    if (move == ChangeDiagonal)
    {
      diagonal = 1 - diagonal;
      continue;
    }
    if (knit.OuterMoves(i, j, move))
    {
      result.departs = result.departs || knit.DepartureAfter(i, j, move) > guide.GetLimit();
      outer.letters.push_back(move);
    }
    (move == AdvanceLower ? i : j) += 1;
  }
  return result;
}
} // namespace tiling
} // namespace bone
