/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePieceMatching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace bone
{
namespace tiling
{
namespace
{
using Polygon = std::vector<Vector2>;

constexpr double MinimumOverlap = 0.15;     // of the smaller piece's area
constexpr double ReachInSlabHeights = 0.75; // a piece that overlaps none may belong to one nearer than this
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

/** A lower and an upper piece of a slab. */
struct Link
{
  int    slab, lower, upper;
  double separation; ///< in slab heights; negative where they overlap
};

/** Sets of numbers that can be joined. */
class DisjointSets
{
public:
  explicit DisjointSets(int count)
    : m_Root(count)
  {
    std::iota(m_Root.begin(), m_Root.end(), 0);
  }

  int
  Find(int i)
  {
    while (m_Root[i] != i)
    {
      i = m_Root[i] = m_Root[m_Root[i]];
    }
    return i;
  }

  /** False where they were one already. */
  bool
  Join(int i, int j)
  {
    const bool apart = Find(i) != Find(j);
    m_Root[Find(j)] = Find(i);
    return apart;
  }

private:
  std::vector<int> m_Root;
};

class Matcher
{
public:
  Matcher(const std::vector<std::vector<PieceOutline>> & pieces,
          const std::vector<double> &                    heights,
          const ContourCorrespondence *                  given)
    : m_Pieces(pieces)
    , m_Heights(heights)
    , m_Given(given)
    , m_First(pieces.size() + 1, 0)
    , m_Bodies(0)
  {
    for (std::size_t k = 0; k < pieces.size(); ++k)
    {
      m_First[k + 1] = m_First[k] + static_cast<int>(pieces[k].size());
    }
    m_Bodies = DisjointSets(m_First.back());
    for (auto & linked : m_Linked)
    {
      linked.assign(static_cast<std::size_t>(m_First.back()), 0);
    }
  }

  std::vector<std::vector<Group>>
  Run()
  {
    const int slabs = static_cast<int>(m_Pieces.size()) - 1;
    m_Links.resize(std::max(slabs, 0));
    for (int k = 0; k < slabs; ++k)
    {
      IsGiven(k) ? AddGiven(k) : LinkByOverlap(k);
    }
    LinkByDistance();
    std::vector<std::vector<Group>> groups;
    for (int k = 0; k < slabs; ++k)
    {
      groups.push_back(GroupsOf(k));
    }
    return groups;
  }

private:
  bool
  IsGiven(int k) const
  {
    return m_Given != nullptr && m_Given->slabs.count(k) > 0;
  }

  const Polygon &
  Outline(int k, int i) const
  {
    return m_Pieces[k][i].loops.front().points;
  }

  int
  Size(int k) const
  {
    return static_cast<int>(m_Pieces[k].size());
  }

  bool
  Add(int k, int i, int j)
  {
    m_Links[k].push_back({ k, i, j, 0.0 });
    m_Linked[0][m_First[k] + i] = m_Linked[1][m_First[k + 1] + j] = 1;
    return m_Bodies.Join(m_First[k] + i, m_First[k + 1] + j);
  }

  int
  PieceOf(int slice, int id) const
  {
    for (int i = 0; i < Size(slice); ++i)
    {
      if (m_Pieces[slice][i].loops.front().id == id)
      {
        return i;
      }
    }
    throw std::runtime_error(PlaceOf(slice, id) + "the correspondence names it, but it is no outer contour there");
  }

  void
  AddGiven(int k)
  {
    std::array<std::vector<char>, 2> taken{ { std::vector<char>(Size(k), 0), std::vector<char>(Size(k + 1), 0) } };
    for (const auto & group : m_Given->slabs.at(k))
    {
      std::array<std::vector<int>, 2> members;
      for (int side = 0; side < 2; ++side)
      {
        for (int id : side == 0 ? group.lower : group.upper)
        {
          members[side].push_back(PieceOf(k + side, id));
          if (taken[side][members[side].back()]++)
          {
            throw std::runtime_error(PlaceOf(k + side, id) + "the correspondence names it twice");
          }
        }
      }
      for (int i : members[0])
      {
        for (int j : members[1])
        {
          Add(k, i, j);
        }
      }
    }
  }

  /** Pieces that overlap little are joined where one of them has no other counterpart. */
  void
  LinkByOverlap(int k)
  {
    std::vector<Link> little;
    for (int i = 0; i < Size(k); ++i)
    {
      for (int j = 0; j < Size(k + 1); ++j)
      {
        const double overlap = Overlap(Outline(k, i), Outline(k + 1, j));
        if (overlap > MinimumOverlap)
        {
          Add(k, i, j);
        }
        else if (overlap > 0)
        {
          little.push_back({ k, i, j, -overlap });
        }
      }
    }
    std::stable_sort(
      little.begin(), little.end(), [](const Link & a, const Link & b) { return a.separation < b.separation; });
    for (const Link & link : little)
    {
      if (!Above(link) || !Below(link))
      {
        Add(k, link.lower, link.upper);
      }
    }
  }

  /** Whether the lower piece of a link has a counterpart above; the upper one below. */
  bool
  Above(const Link & link) const
  {
    return m_Linked[0][m_First[link.slab] + link.lower];
  }
  bool
  Below(const Link & link) const
  {
    return m_Linked[1][m_First[link.slab + 1] + link.upper];
  }

  void
  LinkByDistance()
  {
    std::vector<Link> candidates;
    for (int k = 0; k + 1 < static_cast<int>(m_Pieces.size()); ++k)
    {
      for (int i = 0; i < Size(k) && !IsGiven(k); ++i)
      {
        for (int j = 0; j < Size(k + 1); ++j)
        {
          Link link{ k, i, j, 0.0 };
          if (Above(link) && Below(link))
          {
            continue;
          }
          link.separation = Separation(Outline(k, i), Outline(k + 1, j)) / (m_Heights[k + 1] - m_Heights[k]);
          if (link.separation < ReachInSlabHeights)
          {
            candidates.push_back(link);
          }
        }
      }
    }
    std::stable_sort(
      candidates.begin(), candidates.end(), [](const Link & a, const Link & b) { return a.separation < b.separation; });
    for (const Link & link : candidates)
    {
      if (!Above(link) && !Below(link))
      {
        Add(link.slab, link.lower, link.upper);
      }
    }
    for (const Link & link : candidates)
    {
      const int lower = m_First[link.slab] + link.lower, upper = m_First[link.slab + 1] + link.upper;
      if (Above(link) != Below(link) && m_Bodies.Find(lower) != m_Bodies.Find(upper))
      {
        Add(link.slab, link.lower, link.upper);
      }
    }
  }

  /** The groups of pieces that links connect in slab k. */
  std::vector<Group>
  GroupsOf(int k) const
  {
    DisjointSets joined(Size(k) + Size(k + 1));
    for (const Link & link : m_Links[k])
    {
      joined.Join(link.lower, Size(k) + link.upper);
    }
    std::vector<Group> groups;
    std::vector<int>   groupOf(static_cast<std::size_t>(Size(k) + Size(k + 1)), -1);
    for (int i = 0; i < Size(k) + Size(k + 1); ++i)
    {
      int & group = groupOf[joined.Find(i)];
      if (group < 0)
      {
        group = static_cast<int>(groups.size());
        groups.emplace_back();
      }
      (i < Size(k) ? groups[group].lower : groups[group].upper).push_back(i < Size(k) ? i : i - Size(k));
    }
    return groups;
  }

  const std::vector<std::vector<PieceOutline>> & m_Pieces;
  const std::vector<double> &                    m_Heights;
  const ContourCorrespondence *                  m_Given;
  std::vector<int>                               m_First;  ///< number of the first piece of each slice
  DisjointSets                                   m_Bodies; ///< of all pieces
  std::array<std::vector<char>, 2>               m_Linked; ///< of all pieces: above, below
  std::vector<std::vector<Link>>                 m_Links;  ///< of each slab
};
} // namespace

std::vector<std::vector<Group>>
MatchPieces(const std::vector<std::vector<PieceOutline>> & pieces,
            const std::vector<double> &                    heights,
            const ContourCorrespondence *                  given)
{
  return Matcher(pieces, heights, given).Run();
}
} // namespace tiling
} // namespace bone
