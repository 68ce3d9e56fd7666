/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionJoin.h"

#include "boneContourStack.h"

#include "boneRingTriangulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace bone
{
namespace tiling
{
namespace
{
/** A way inward from the outer walk: the position on the outer walk of each ring and on its inner walk, and the state
 * of the ring there. */
struct Chain
{
  std::vector<int> outer;
  std::vector<int> inner;
  std::vector<int> state;
};

/** Position on walks[ring + 1] of a position on inner[ring]; -1 on a spur or where one is left. */
int
PositionWithin(const Section & section, int ring, int position)
{
  int shift = 0;
  for (const Spur & spur : section.spurs[ring])
  {
    if (position < spur.position + shift)
    {
      break;
    }
    if (position <= spur.position + shift + spur.length)
    {
      return -1;
    }
    shift += spur.length;
  }
  return position - shift;
}

/** The chain of shortest spanning edges at a position of the outer walk, through `depth` rings; false where it meets a
 * spur. */
bool
ChainAt(const std::vector<Vector2> & plane, const Section & section, int position, int depth, Chain & chain)
{
  int here = position;
  for (int k = 0; k < depth; ++k)
  {
    const Walk &  outer = section.walks[k];
    const Walk &  inner = section.inner[k];
    const Merge & ring = section.rings[k];
    int           i = ring.first, j = ring.second, bestState = 0, bestInner = 0;
    double        best = std::numeric_limits<double>::infinity();
    for (int s = 0; s < std::max<int>(1, static_cast<int>(ring.letters.size())); ++s)
    {
      if ((i - here) % static_cast<int>(outer.size()) == 0)
      {
        const double length = (plane[outer[i % outer.size()]] - plane[inner[j % inner.size()]]).norm();
        if (length < best)
        {
          best = length;
          bestState = s;
          bestInner = j % static_cast<int>(inner.size());
        }
      }
      if (s < static_cast<int>(ring.letters.size()))
      {
        (ring.letters[s] == 0 ? i : j) += 1;
      }
    }
    chain.outer.push_back(here);
    chain.state.push_back(bestState);
    chain.inner.push_back(bestInner);
    here = PositionWithin(section, k, bestInner);
    if (here < 0)
    {
      return false;
    }
  }
  chain.outer.push_back(here);
  return true;
}

/** Path between the walks of level k of two sections: up one chain, over the bridge, down the other. */
std::vector<int>
LinkPath(const Section & p, const Chain & cp, const Section & q, const Chain & cq, int level)
{
  std::vector<int> path;
  const auto       add = [&path](int v) {
    if (path.empty() || path.back() != v)
    {
      path.push_back(v);
    }
  };
  for (int k = level; k >= 0; --k)
  {
    add(p.walks[k][cp.outer[k]]);
  }
  for (int k = 0; k <= level; ++k)
  {
    add(q.walks[k][cq.outer[k]]);
  }
  return path;
}

/** The walk from `position` once round, back to where it began. */
Walk
Rotated(const Walk & walk, int position)
{
  Walk result;
  for (std::size_t i = 0; i < walk.size(); ++i)
  {
    result.push_back(walk[(position + i) % walk.size()]);
  }
  if (walk.size() > 1)
  {
    result.push_back(walk[position]);
  }
  return result;
}

/** Round p, over the link, round q and back over the link. */
Walk
Joined(const Walk & p, int atP, const std::vector<int> & link, const Walk & q, int atQ)
{
  Walk walk = Rotated(p, atP);
  walk.insert(walk.end(), link.begin() + 1, link.end() - 1);
  const Walk other = Rotated(q, atQ);
  walk.insert(walk.end(), other.begin(), other.end());
  walk.insert(walk.end(), link.rbegin() + 1, link.rend() - 1);
  return walk;
}

std::vector<std::uint8_t>
RotatedLetters(const Merge & ring, int state)
{
  std::vector<std::uint8_t> letters;
  for (std::size_t s = 0; s < ring.letters.size(); ++s)
  {
    letters.push_back(ring.letters[(state + s) % ring.letters.size()]);
  }
  return letters;
}

/** Letters of the joined ring k: round p, along the link (where the ring has no extent), round q and back. */
std::vector<std::uint8_t>
JoinedLetters(const Section &          p,
              const Chain &            cp,
              const Section &          q,
              const Chain &            cq,
              int                      k,
              const std::vector<int> & link,
              const std::vector<int> & linkInside)
{
  const bool descendsP = link.front() != linkInside.front();
  const bool descendsQ = link.back() != linkInside.back();
  auto       letters = RotatedLetters(p.rings[k], cp.state[k]);
  const auto along = [&](bool first, bool last) {
    letters.insert(letters.end(), first ? 1 : 0, 1);
    for (std::size_t s = 1; s < link.size(); ++s)
    {
      letters.push_back(0);
      letters.push_back(1);
    }
    letters.insert(letters.end(), last ? 1 : 0, 1);
  };
  along(descendsP, descendsQ);
  const auto other = RotatedLetters(q.rings[k], cq.state[k]);
  letters.insert(letters.end(), other.begin(), other.end());
  along(descendsQ, descendsP);
  return letters;
}

/** Shifts the spurs of a walk of n steps that is begun at `start` instead. */
std::vector<Spur>
RotatedSpurs(const std::vector<Spur> & spurs, int start, int n)
{
  std::vector<Spur> result;
  for (const Spur & spur : spurs)
  {
    result.push_back({ (spur.position - start + n) % n, spur.length });
  }
  std::stable_sort(
    result.begin(), result.end(), [](const Spur & a, const Spur & b) { return a.position < b.position; });
  return result;
}

/** Walks and rings of the layers that both have, joined over the links. */
void
JoinCommonLayers(const Section &                       p,
                 const Chain &                         cp,
                 const Section &                       q,
                 const Chain &                         cq,
                 const std::vector<std::vector<int>> & links,
                 int                                   last,
                 Section &                             composite)
{
  for (int k = 0; k < last; ++k)
  {
    const int np = static_cast<int>(p.walks[k + 1].size()), nq = static_cast<int>(q.walks[k + 1].size());
    composite.walks[k] = Joined(p.walks[k], cp.outer[k], links[k], q.walks[k], cq.outer[k]);
    composite.inner[k] = Joined(p.inner[k], cp.inner[k], links[k + 1], q.inner[k], cq.inner[k]);
    composite.rings[k] = Merge{ 0, 0, JoinedLetters(p, cp, q, cq, k, links[k], links[k + 1]) };
    composite.spurs[k] = RotatedSpurs(p.spurs[k], cp.outer[k + 1], np);
    const int offset = WalkSteps(p.walks[k + 1]) + static_cast<int>(links[k + 1].size()) - 1;
    for (const Spur & spur : RotatedSpurs(q.spurs[k], cq.outer[k + 1], nq))
    {
      composite.spurs[k].push_back({ offset + spur.position, spur.length });
    }
  }
}

/** Joins q, which has fewer layers or as many, to p. Layers that both have are joined; inside the innermost of q the
 * bridge and q are a detour of p's walk, which the deeper layers of p do not take part in. */
Section
Bridge(const Section & p, const Chain & cp, const Section & q, const Chain & cq)
{
  const int                     common = q.depth, rings = static_cast<int>(p.rings.size());
  Section                       composite = p;
  std::vector<std::vector<int>> links;
  for (int k = 0; k <= common; ++k)
  {
    links.push_back(LinkPath(p, cp, q, cq, k));
  }
  if (p.depth == common)
  {
    JoinCommonLayers(p, cp, q, cq, links, common, composite);
    const Walk innermost = Joined(p.walks[common], cp.outer[common], links[common], q.walks[common], cq.outer[common]);
    composite.walks[common] = innermost;
    for (int k = common; k < rings; ++k)
    {
      composite.walks[k + 1] = composite.inner[k] = innermost;
      composite.rings[k] = DegenerateRing(innermost);
    }
    composite.hole = p.hole || q.hole;
    return composite;
  }
  JoinCommonLayers(p, cp, q, cq, links, common - 1, composite);
  // The last common ring: its inner walk leaves p's at the chain, goes over the link and round q, and comes back.
  const int  k = common - 1;
  const Walk other = Rotated(q.inner[k], cq.inner[k]);
  Walk       detour(links[common].begin() + 1, links[common].end() - 1);
  detour.insert(detour.end(), other.begin(), other.end());
  detour.insert(detour.end(), links[common].rbegin() + 1, links[common].rend());
  const int length = static_cast<int>(detour.size());
  composite.walks[k] = Joined(p.walks[k], cp.outer[k], links[k], q.walks[k], cq.outer[k]);
  composite.inner[k].insert(composite.inner[k].begin() + cp.inner[k] + 1, detour.begin(), detour.end());
  composite.rings[k] = Merge{ 0, cp.inner[k] + length, JoinedLetters(p, cp, q, cq, k, links[k], links[common]) };
  composite.spurs[k].push_back({ cp.outer[k + 1], length });
  composite.spurs[k] = RotatedSpurs(composite.spurs[k], 0, static_cast<int>(p.walks[k + 1].size()));
  return composite;
}

void
MarkPath(const std::vector<int> & path, EdgeSet & used)
{
  for (std::size_t i = 1; i < path.size(); ++i)
  {
    used.insert({ std::min(path[i - 1], path[i]), std::max(path[i - 1], path[i]) });
  }
}

bool
Touches(const std::vector<int> & path, const EdgeSet & used)
{
  for (std::size_t i = 1; i < path.size(); ++i)
  {
    if (used.count({ std::min(path[i - 1], path[i]), std::max(path[i - 1], path[i]) }) > 0)
    {
      return true;
    }
  }
  return false;
}

/** Joins q, which has fewer layers or as many, to p by the shortest bridge whose way inward shares no edge with an
 * earlier one. */
bool
JoinPair(const std::vector<Vector2> & plane, const Section & p, const Section & q, EdgeSet & used, Section & composite)
{
  struct Candidate
  {
    double length;
    int    i, j;
  };
  std::vector<Candidate> candidates;
  for (int i = 0; i < static_cast<int>(p.walks[0].size()); ++i)
  {
    for (int j = 0; j < static_cast<int>(q.walks[0].size()); ++j)
    {
      candidates.push_back({ (plane[p.walks[0][i]] - plane[q.walks[0][j]]).norm(), i, j });
    }
  }
  const std::size_t tries = std::min<std::size_t>(candidates.size(), 64);
  std::partial_sort(candidates.begin(),
                    candidates.begin() + static_cast<std::ptrdiff_t>(tries),
                    candidates.end(),
                    [](const Candidate & a, const Candidate & b) {
                      return a.length != b.length ? a.length < b.length : std::tie(a.i, a.j) < std::tie(b.i, b.j);
                    });
  for (std::size_t c = 0; c < tries; ++c)
  {
    Chain cp, cq;
    if (!ChainAt(plane, p, candidates[c].i, q.depth, cp) || !ChainAt(plane, q, candidates[c].j, q.depth, cq))
    {
      continue;
    }
    const auto path = LinkPath(p, cp, q, cq, q.depth);
    if (!Touches(path, used))
    {
      MarkPath(path, used);
      composite = Bridge(p, cp, q, cq);
      return true;
    }
  }
  return false;
}

double
Separation(const std::vector<Vector2> & plane, const Section & p, const Section & q)
{
  double best = std::numeric_limits<double>::infinity();
  for (int a : p.walks[0])
  {
    for (int b : q.walks[0])
    {
      best = std::min(best, (plane[a] - plane[b]).norm());
    }
  }
  return best;
}

} // namespace

Section
WithRegions(const Section & section, const std::vector<int> & regions)
{
  Section     result;
  std::size_t own = 0;
  result.region = regions;
  result.hole = section.hole;
  result.slice = section.slice;
  for (int region : regions)
  {
    result.walks.push_back(section.walks[own]);
    if (own < section.region.size() && section.region[own] == region)
    {
      result.rings.push_back(section.rings[own]);
      ++own;
    }
    else
    {
      result.rings.push_back(DegenerateRing(section.walks[own]));
    }
  }
  result.walks.push_back(section.walks[own]);
  result.inner.assign(result.walks.begin() + 1, result.walks.end());
  result.spurs.resize(result.rings.size());
  result.depth =
    static_cast<int>(std::upper_bound(regions.begin(), regions.end(), section.region.back()) - regions.begin());
  return result;
}

bool
JoinSections(const std::vector<Vector2> & plane,
             const std::vector<Section> & sections,
             EdgeSet &                    used,
             Section &                    composite)
{
  composite = sections.front();
  std::vector<std::size_t> rest(sections.size() - 1);
  std::iota(rest.begin(), rest.end(), 1);
  while (!rest.empty())
  {
    const auto      nearest = std::min_element(rest.begin(), rest.end(), [&](std::size_t a, std::size_t b) {
      return Separation(plane, composite, sections[a]) < Separation(plane, composite, sections[b]);
    });
    Section         joined;
    const Section & next = sections[*nearest];
    const bool      deeper = next.depth > composite.depth;
    if (!JoinPair(plane, deeper ? next : composite, deeper ? composite : next, used, joined))
    {
      return false;
    }
    composite = std::move(joined);
    rest.erase(nearest);
  }
  return true;
}

Merge
WithSpurs(const std::vector<Vector2> & plane,
          const Section &              lower,
          const Section &              upper,
          int                          ring,
          const Merge &                wall)
{
  if (lower.spurs[ring].empty() && upper.spurs[ring].empty())
  {
    return wall;
  }
  const int        n = static_cast<int>(wall.letters.size());
  const Section *  sections[2] = { &lower, &upper };
  std::vector<int> emitted[2]; // steps to walk at each state of the wall
  Merge            result;
  for (int side = 0; side < 2; ++side)
  {
    const Section & own = *sections[side];
    const Walk &    walk = own.walks[ring + 1];
    const Walk &    opposite = sections[1 - side]->walks[ring + 1];
    const int       size = static_cast<int>(walk.size());
    const int       begin = side == 0 ? wall.first : wall.second;
    const int       oppositeBegin = side == 0 ? wall.second : wall.first;
    emitted[side].assign(static_cast<std::size_t>(n) + 1, 0);
    int shift = 0, before = 0;
    for (const Spur & spur : own.spurs[ring])
    {
      // The detour's middle is where it goes to; the opposite walk's vertex nearest to it is the host.
      const Vector2 target = plane[own.inner[ring][spur.position + shift + spur.length / 2]];
      double        best = std::numeric_limits<double>::infinity();
      int           host = 0, p = 0, q = 0;
      for (int m = 0; m <= n; ++m)
      {
        if ((begin + p - spur.position) % size == 0 && (p < size || size == 1))
        {
          const double d = (plane[opposite[(oppositeBegin + q) % opposite.size()]] - target).norm();
          if (d < best)
          {
            best = d;
            host = m;
          }
        }
        if (m < n)
        {
          (wall.letters[m] == side ? p : q) += 1;
        }
      }
      emitted[side][host] += spur.length;
      before += spur.position < begin % size ? spur.length : 0;
      shift += spur.length;
    }
    (side == 0 ? result.first : result.second) = begin % size + before;
  }
  for (int m = 0; m <= n; ++m)
  {
    result.letters.insert(result.letters.end(), static_cast<std::size_t>(emitted[0][m]), 0);
    result.letters.insert(result.letters.end(), static_cast<std::size_t>(emitted[1][m]), 1);
    if (m < n)
    {
      result.letters.push_back(wall.letters[m]);
    }
  }
  return result;
}

std::vector<int>
RegionsOf(const std::vector<Section> & sections)
{
  std::set<int> regions;
  for (const Section & section : sections)
  {
    regions.insert(section.region.begin(), section.region.end());
  }
  return { regions.begin(), regions.end() };
}

bool
Compose(const std::vector<Vector2> & plane,
        const std::vector<Section> & sections,
        const std::vector<int> &     regions,
        EdgeSet &                    used,
        Section &                    composite)
{
  std::vector<Section> aligned;
  for (const Section & section : sections)
  {
    if (!section.patch.empty())
    {
      return false;
    }
    aligned.push_back(WithRegions(section, regions));
  }
  return JoinSections(plane, aligned, used, composite);
}
} // namespace tiling
} // namespace bone
