/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionSplit.h"

#include "boneContourDistance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace tiling
{
namespace
{
constexpr double LengthWeight = 0.25; // of a cut's length times the contour's mean edge squared

/** A way inward along spanning edges: its position on each walk, outside in, and the state of each ring there. */
struct CutChain
{
  std::vector<int> position;
  std::vector<int> state;
  std::vector<int> vertex; ///< at each position
};

/** A state of a ring at a position of its outer walk, and the position of the inner walk there. */
struct RingState
{
  int state;
  int inner;
};

/** The states of a ring by the position on its outer walk. */
std::vector<std::vector<RingState>>
StatesOf(const Section & section, int ring)
{
  const int                           outer = static_cast<int>(section.walks[ring].size());
  const int                           inner = static_cast<int>(section.walks[ring + 1].size());
  std::vector<std::vector<RingState>> states(section.walks[ring].size());
  int                                 i = section.rings[ring].first, j = section.rings[ring].second, s = 0;
  for (const std::uint8_t letter : section.rings[ring].letters)
  {
    states[i % outer].push_back({ s++, j % inner });
    (letter == 0 ? i : j) += 1;
  }
  return states;
}

/** All ways from the outer contour to the innermost walk that go by the shortest spanning edge at each vertex, and in
 * the innermost ring by any. */
std::vector<CutChain>
FindChains(const std::vector<Vector2> & plane, const Section & section)
{
  const int                                        rings = static_cast<int>(section.rings.size());
  std::vector<std::vector<std::vector<RingState>>> states;
  for (int k = 0; k < rings; ++k)
  {
    states.push_back(StatesOf(section, k));
  }
  std::vector<CutChain> chains;
  for (int start = 0; start < static_cast<int>(section.walks[0].size()); ++start)
  {
    CutChain chain;
    chain.position.push_back(start);
    for (int k = 0; k + 1 < rings; ++k)
    {
      const auto & here = states[k][chain.position[k]];
      const auto   length = [&](const RingState & s) {
        return (plane[section.walks[k][chain.position[k]]] - plane[section.walks[k + 1][s.inner]]).squaredNorm();
      };
      const auto best = std::min_element(
        here.begin(), here.end(), [&](const RingState & s, const RingState & t) { return length(s) < length(t); });
      chain.state.push_back(best->state);
      chain.position.push_back(best->inner);
    }
    for (const RingState & last : states[rings - 1][chain.position[rings - 1]])
    {
      CutChain whole = chain;
      whole.state.push_back(last.state);
      whole.position.push_back(last.inner);
      for (int k = 0; k <= rings; ++k)
      {
        whole.vertex.push_back(section.walks[k][whole.position[k]]);
      }
      chains.push_back(std::move(whole));
    }
  }
  return chains;
}

/** From chain b's vertex on walk `level` inward and out to chain a's, each vertex once. */
std::vector<int>
CutPath(const CutChain & a, const CutChain & b, int level)
{
  std::vector<int> path;
  const auto       add = [&path](int v) {
    if (path.empty() || path.back() != v)
    {
      path.push_back(v);
    }
  };
  const int last = static_cast<int>(a.vertex.size()) - 1;
  for (int k = level; k <= last; ++k)
  {
    add(b.vertex[k]);
  }
  for (int k = last; k >= level; --k)
  {
    add(a.vertex[k]);
  }
  return path;
}

/** Letters of a ring from chain a's state to chain b's. */
std::vector<std::uint8_t>
LettersBetween(const Merge & ring, int from, int to)
{
  std::vector<std::uint8_t> letters;
  for (int s = from, n = static_cast<int>(ring.letters.size()); s != to; s = (s + 1) % n)
  {
    letters.push_back(ring.letters[s]);
  }
  return letters;
}

/** The part of a section from chain a counter-clockwise to chain b. */
Section
PartBetween(const Section & section, const CutChain & a, const CutChain & b)
{
  const int rings = static_cast<int>(section.rings.size());
  Section   part;
  part.region = section.region;
  part.slice = section.slice;
  part.depth = section.depth;
  part.spurs.resize(section.rings.size());
  const auto along = [&](int level, std::ptrdiff_t steps) {
    Walk walk;
    for (std::ptrdiff_t i = 0; i < steps; ++i)
    {
      walk.push_back(section.walks[level][(a.position[level] + i) % section.walks[level].size()]);
    }
    return walk;
  };
  std::ptrdiff_t innermost = 0;
  for (int k = 0; k < rings; ++k)
  {
    Merge      ring{ 0, 0, LettersBetween(section.rings[k], a.state[k], b.state[k]) };
    const auto steps = std::count(ring.letters.begin(), ring.letters.end(), 0);
    innermost = static_cast<std::ptrdiff_t>(ring.letters.size()) - steps;
    const auto path = CutPath(a, b, k), inside = CutPath(a, b, k + 1);
    Walk       walk = along(k, steps);
    walk.insert(walk.end(), path.begin(), path.end() - 1);
    part.walks.push_back(std::move(walk));
    // Along the cut the ring has no extent: its outer walk goes in to the inner one, both go on, and it comes out.
    ring.letters.insert(ring.letters.end(), b.vertex[k] != b.vertex[k + 1] ? 1 : 0, 0);
    for (std::size_t i = 1; i < inside.size(); ++i)
    {
      ring.letters.insert(ring.letters.end(), { 0, 1 });
    }
    ring.letters.insert(ring.letters.end(), a.vertex[k] != a.vertex[k + 1] ? 1 : 0, 0);
    part.rings.push_back(std::move(ring));
  }
  part.walks.push_back(along(rings, std::max<std::ptrdiff_t>(innermost, 1)));
  part.inner.assign(part.walks.begin() + 1, part.walks.end());
  return part;
}

double
CrossProduct(const Vector2 & u, const Vector2 & v)
{
  return u.x() * v.y() - u.y() * v.x();
}

/** Area of some polygons together, and the sum of area times place in `moment`. */
double
AreaOf(const std::vector<std::vector<Vector2>> & polygons, Vector2 & moment)
{
  double twice = 0.0;
  moment.setZero();
  for (const auto & polygon : polygons)
  {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    {
      const double part = CrossProduct(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
      twice += part;
      moment += part * (polygon[0] + polygon[i] + polygon[i + 1]) / 6.0;
    }
  }
  return 0.5 * twice;
}

/** Splits off one part after the other. */
class Splitter
{
public:
  Splitter(const std::vector<Vector2> & plane, const CutTrace & taken, CutTrace & made)
    : m_Plane(plane)
    , m_Taken(taken)
    , m_Made(made)
  {}

  bool
  Run(const Section & section, const std::vector<std::vector<Vector2>> & counterparts, std::vector<Section> & parts)
  {
    Measure(section, counterparts);
    parts.assign(counterparts.size(), Section{});
    Section          rest = section;
    std::vector<int> left;
    for (std::size_t i = 0; i < counterparts.size(); ++i)
    {
      left.push_back(static_cast<int>(i));
    }
    while (left.size() > 1)
    {
      const Cut cut = BestCut(rest, left);
      if (cut.counterpart < 0)
      {
        return false;
      }
      Mark(cut);
      parts[cut.counterpart] = PartBetween(rest, cut.from, cut.to);
      rest = PartBetween(rest, cut.to, cut.from);
      left.erase(std::find(left.begin(), left.end(), cut.counterpart));
    }
    parts[left.front()] = std::move(rest);
    return true;
  }

private:
  struct Cut
  {
    double   cost{ Infinity };
    int      counterpart{ -1 };
    CutChain from, to; ///< the part lies from one counter-clockwise to the other
  };

  /** Moves the counterparts over the section. */
  void
  Measure(const Section & section, const std::vector<std::vector<Vector2>> & counterparts)
  {
    std::vector<Vector2> outline;
    for (int v : section.walks[0])
    {
      outline.push_back(m_Plane[v]);
    }
    double length = 0.0;
    for (std::size_t i = 0; i < outline.size(); ++i)
    {
      length += (outline[(i + 1) % outline.size()] - outline[i]).norm();
    }
    const double step = length / static_cast<double>(outline.size());
    m_LengthCost = LengthWeight * step * step;
    Vector2       own, others;
    const double  area = AreaOf({ outline }, own), areas = AreaOf(counterparts, others);
    const Vector2 move = own / area - others / areas;
    for (const auto & polygon : counterparts)
    {
      m_Distances.emplace_back(polygon, move);
    }
  }

  /** Sums over the ring's states of area times (distance to counterpart i - distance to the nearest other one). */
  std::vector<double>
  Sums(const Section & section, int ring, int counterpart, const std::vector<int> & left) const
  {
    const Walk &        outer = section.walks[ring];
    const Walk &        inner = section.walks[ring + 1];
    std::vector<double> sums{ 0.0 };
    int                 i = section.rings[ring].first, j = section.rings[ring].second;
    for (const std::uint8_t letter : section.rings[ring].letters)
    {
      const Vector2 &a = m_Plane[outer[i % outer.size()]], &c = m_Plane[inner[j % inner.size()]];
      (letter == 0 ? i : j) += 1;
      const Vector2 & b = letter == 0 ? m_Plane[outer[i % outer.size()]] : m_Plane[inner[j % inner.size()]];
      const double    area = 0.5 * CrossProduct(b - a, c - a);
      const Vector2   q = (a + b + c) / 3.0;
      double          other = Infinity;
      for (int o : left)
      {
        other = o == counterpart || area == 0 ? other : std::min(other, m_Distances[o].At(q));
      }
      sums.push_back(sums.back() + (area == 0 ? 0.0 : area * (m_Distances[counterpart].At(q) - other)));
    }
    return sums;
  }

  Cut
  BestCut(const Section & section, const std::vector<int> & left) const
  {
    std::vector<CutChain> chains;
    for (CutChain & chain : FindChains(m_Plane, section))
    {
      if (IsFree(chain))
      {
        chains.push_back(std::move(chain));
      }
    }
    Cut best;
    for (int counterpart : left)
    {
      std::vector<std::vector<double>> sums;
      for (std::size_t k = 0; k < section.rings.size(); ++k)
      {
        sums.push_back(Sums(section, static_cast<int>(k), counterpart, left));
      }
      for (const CutChain & from : chains)
      {
        for (const CutChain & to : chains)
        {
          if (from.vertex.back() != to.vertex.back() || from.vertex.front() == to.vertex.front())
          {
            continue;
          }
          const double cost = Cost(sums, from, to);
          if (cost < best.cost && AreApart(from, to))
          {
            best = { cost, counterpart, from, to };
          }
        }
      }
    }
    return best;
  }

  double
  Cost(const std::vector<std::vector<double>> & sums, const CutChain & from, const CutChain & to) const
  {
    double cost = 0.0;
    for (std::size_t k = 0; k < sums.size(); ++k)
    {
      cost += sums[k][to.state[k]] - sums[k][from.state[k]];
      cost += to.state[k] < from.state[k] ? sums[k].back() : 0.0;
    }
    return cost + m_LengthCost * (Length(from) + Length(to));
  }

  double
  Length(const CutChain & chain) const
  {
    double length = 0.0;
    for (std::size_t k = 1; k < chain.vertex.size(); ++k)
    {
      length += (m_Plane[chain.vertex[k]] - m_Plane[chain.vertex[k - 1]]).norm();
    }
    return length;
  }

  /** Whether a chain keeps off the cuts that were made, but for their vertices, and off those taken. */
  bool
  IsFree(const CutChain & chain) const
  {
    for (std::size_t k = 1; k < chain.vertex.size(); ++k)
    {
      const auto edge = std::minmax(chain.vertex[k - 1], chain.vertex[k]);
      if (m_Taken.vertices.count(chain.vertex[k]) > 0 || m_Taken.edges.count(edge) > 0 || m_Made.edges.count(edge) > 0)
      {
        return false;
      }
    }
    return true;
  }

  /** Whether two chains meet in their last vertex only. */
  static bool
  AreApart(const CutChain & a, const CutChain & b)
  {
    const auto end = std::find(b.vertex.begin(), b.vertex.end(), b.vertex.back());
    return std::none_of(
      b.vertex.begin(), end, [&a](int v) { return std::find(a.vertex.begin(), a.vertex.end(), v) != a.vertex.end(); });
  }

  void
  Mark(const Cut & cut)
  {
    for (const CutChain * chain : { &cut.from, &cut.to })
    {
      for (std::size_t k = 1; k < chain->vertex.size(); ++k)
      {
        m_Made.edges.insert(std::minmax(chain->vertex[k - 1], chain->vertex[k]));
        m_Made.vertices.insert(chain->vertex[k]);
      }
    }
  }

  const std::vector<Vector2> & m_Plane;
  const CutTrace &             m_Taken;
  CutTrace &                   m_Made;
  std::vector<ContourDistance> m_Distances; ///< to each counterpart
  double                       m_LengthCost{ 0.0 };
};
} // namespace

void
CutTrace::Add(const CutTrace & other)
{
  edges.insert(other.edges.begin(), other.edges.end());
  vertices.insert(other.vertices.begin(), other.vertices.end());
}

bool
SplitSection(const std::vector<Vector2> &              plane,
             const Section &                           section,
             const std::vector<std::vector<Vector2>> & counterparts,
             const CutTrace &                          taken,
             CutTrace &                                made,
             std::vector<Section> &                    parts)
{
  made = CutTrace{};
  return section.patch.empty() && !section.hole && Splitter(plane, taken, made).Run(section, counterparts, parts);
}
} // namespace tiling
} // namespace bone
