/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabTiler.h"

#include "bonePredicates.h"
#include "boneRingTriangulation.h"
#include "boneSectionJoin.h"
#include "boneWallMerge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace bone
{
namespace tiling
{
namespace
{
constexpr int    KnitBudget = 60; // ring knits tried before another way is taken
constexpr double SkewLimit = 1.5; // of the slab's height and the steps of the walks

/** The longer of the two steps of a walk at each of its vertices, in the plane. */
std::map<int, double>
StepsAt(const std::vector<Vector2> & plane, const Walk & walk)
{
  std::map<int, double> steps;
  for (std::size_t i = 0; i < walk.size(); ++i)
  {
    const int    a = walk[i], b = walk[(i + 1) % walk.size()];
    const double step = (plane[b] - plane[a]).norm();
    for (int v : { a, b })
    {
      steps[v] = std::max(steps[v], step);
    }
  }
  return steps;
}

double
DistanceToWalk(const std::vector<Vector2> & plane, int v, const Walk & walk)
{
  double best = std::numeric_limits<double>::infinity();
  for (int w : walk)
  {
    best = std::min(best, (plane[w] - plane[v]).norm());
  }
  return best;
}

/** True where an edge of a wall joins vertices of two walks that are much farther from each other than from the other's
 * walk: such a wall is twisted and cuts across the bone. */
bool
WallIsSkew(const VertexPool &              pool,
           const std::vector<TiledTetra> & tetrahedra,
           std::size_t                     begin,
           const Walk &                    lower,
           const Walk &                    upper,
           double                          height)
{
  const auto below = StepsAt(pool.plane, lower), above = StepsAt(pool.plane, upper);
  for (std::size_t t = begin; t < tetrahedra.size(); ++t)
  {
    for (const auto & edge : TetraEdges)
    {
      int  a = static_cast<int>(tetrahedra[t].vertices[edge[0]]), b = static_cast<int>(tetrahedra[t].vertices[edge[1]]);
      auto foot = below.find(a), head = above.find(b);
      if (foot == below.end() || head == above.end())
      {
        std::swap(a, b);
        foot = below.find(a);
        head = above.find(b);
      }
      if (foot == below.end() || head == above.end())
      {
        continue;
      }
      const double excess =
        (pool.plane[a] - pool.plane[b]).norm() - SkewLimit * (height + std::max(foot->second, head->second));
      if (excess > 0 && excess > std::max(DistanceToWalk(pool.plane, a, upper), DistanceToWalk(pool.plane, b, lower)))
      {
        return true;
      }
    }
  }
  return false;
}
} // namespace

bool
SlabTiler::KnitFrom(const Section &          lower,
                    const Section &          upper,
                    int                      ring,
                    const Merge &            wall,
                    const std::vector<int> & regions,
                    int &                    budget)
{
  const RingPair  rings{ lower.walks[ring], lower.inner[ring], lower.rings[ring],
                        upper.walks[ring], upper.inner[ring], upper.rings[ring] };
  const Merge     inner = WithSpurs(m_Pool.plane, lower, upper, ring, wall);
  const WallGuide guide(m_Pool, rings.outerLower, rings.outerUpper);
  RingKnit        knit;
  knit.moreStarts = true;
  for (int start = 0; knit.moreStarts; ++start)
  {
    m_Execution.ThrowIfAborted();
    if (budget-- <= 0)
    {
      return false;
    }
    const std::size_t mark = m_Tetrahedra.size();
    Merge             outer;
    knit = KnitRing(m_Pool, rings, inner, m_Metric, guide, start, RegionOfSlot(regions[ring]), outer, m_Tetrahedra);
    if (knit.departs)
    {
      budget = 0; // from other starts walls depart no less
    }
    if (knit.made && !knit.departs && (ring == 0 || KnitFrom(lower, upper, ring - 1, outer, regions, budget)))
    {
      return true;
    }
    m_Tetrahedra.resize(mark);
  }
  return false;
}

bool
SlabTiler::WallsSkew(const Section & lower, const Section & upper, std::size_t begin, double height) const
{
  const std::size_t walls = lower.rings.size() + (lower.hole && upper.hole ? 1 : 0);
  for (std::size_t k = 0; k < walls; ++k)
  {
    if (WallIsSkew(m_Pool, m_Tetrahedra, begin, lower.walks[k], upper.walks[k], height))
    {
      return true;
    }
  }
  return false;
}

bool
SlabTiler::TryKnit(const Section & lower, const Section & upper, const std::vector<int> & regions)
{
  Merge inner;
  for (int variant = 0; MergeInnermostWalks(m_Pool.plane, lower, upper, variant, inner); ++variant)
  {
    int        budget = KnitBudget;
    const int  rings = static_cast<int>(lower.rings.size());
    const auto mark = m_Tetrahedra.size();
    if (KnitFrom(lower, upper, rings - 1, inner, regions, budget))
    {
      const double low = m_Pool.space[lower.walks[0][0]].dot(m_Stack.GetNormal()),
                   high = m_Pool.space[upper.walks[0][0]].dot(m_Stack.GetNormal());
      if (!WallsSkew(lower, upper, mark, high - low) && !WallsCross(m_Pool, m_Stack, m_Tetrahedra, mark, low, high))
      {
        m_Report.alternativeKnits += variant > 0 || budget < KnitBudget - rings;
        return true;
      }
    }
    m_Tetrahedra.resize(mark);
  }
  return false;
}

bool
SlabTiler::TryDirect(const std::vector<Section> & lower, const std::vector<Section> & upper)
{
  std::vector<Section> both = lower;
  both.insert(both.end(), upper.begin(), upper.end());
  const std::vector<int> regions = RegionsOf(both);
  Section                below, above;
  EdgeSet                used = m_UsedEdges;
  if (!Compose(m_Pool.plane, lower, regions, used, below) || !Compose(m_Pool.plane, upper, regions, used, above) ||
      EndsOnBothSides(below, above) || !TryKnit(below, above, regions))
  {
    return false;
  }
  m_UsedEdges = used;
  MarkCollapsed(below);
  MarkCollapsed(above);
  return true;
}

bool
SlabTiler::TrySplit(const std::vector<Section> & lower, const std::vector<Section> & upper)
{
  const bool                        oneBelow = lower.size() == 1;
  const std::vector<Section> &      several = oneBelow ? upper : lower;
  std::vector<std::vector<Vector2>> counterparts;
  for (const Section & section : several)
  {
    counterparts.push_back(OuterPolygon(m_Pool.plane, section));
  }
  CutTrace             cuts;
  std::vector<Section> parts;
  if (!SplitSection(m_Pool.plane, (oneBelow ? lower : upper).front(), counterparts, m_Cuts, cuts, parts))
  {
    return false;
  }
  const std::size_t   mark = m_Tetrahedra.size();
  const std::set<int> collapsed = m_Collapsed;
  for (std::size_t i = 0; i < parts.size(); ++i)
  {
    if (oneBelow ? !TryDirect({ parts[i] }, { several[i] }) : !TryDirect({ several[i] }, { parts[i] }))
    {
      m_Tetrahedra.resize(mark);
      m_Collapsed = collapsed;
      return false;
    }
  }
  m_Cuts.Add(cuts);
  return true;
}

void
SlabTiler::MarkCollapsed(const Section & section)
{
  if (section.depth < static_cast<int>(section.rings.size()))
  {
    m_Collapsed.insert(section.walks.back().begin(), section.walks.back().end());
  }
}

bool
SlabTiler::EndsOnBothSides(const Section & lower, const Section & upper) const
{
  for (const Section * section : { &lower, &upper })
  {
    const Walk & walk = section->walks.back();
    if (section->depth < static_cast<int>(section->rings.size()) &&
        std::any_of(walk.begin(), walk.end(), [this](int v) { return m_Collapsed.count(v) > 0; }))
    {
      return true;
    }
  }
  return false;
}

Section
SlabTiler::RidgeOver(const Section & section, double height)
{
  std::vector<int>     path = LongestPath(m_Pool.plane, section.walks.back());
  std::vector<Vector2> points;
  for (int v : path)
  {
    points.push_back(m_Pool.plane[v]);
  }
  // The ridge is shorter than the axis at both ends, as the bone narrows there too.
  if (points.size() > 2)
  {
    points = std::vector<Vector2>(points.begin() + 1, points.end() - 1);
  }
  else if (points.size() == 2)
  {
    points = { Vector2(0.5 * (points[0] + points[1])) };
  }
  PlanarTree       tree;
  std::vector<int> ids;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    tree.points.push_back(points[i]);
    ids.push_back(m_Pool.Add(points[i], m_Stack.FromPlane(points[i], height), 0, section.slice));
    if (i > 0)
    {
      tree.edges.push_back({ { static_cast<int>(i) - 1, static_cast<int>(i) } });
    }
  }
  Section ridge;
  ridge.region = section.region;
  ridge.slice = section.slice;
  ridge.walks.assign(section.walks.size(), TreeWalk(tree, ids));
  ridge.inner.assign(section.rings.size(), ridge.walks[0]);
  ridge.spurs.resize(section.rings.size());
  ridge.rings.assign(section.rings.size(), DegenerateRing(ridge.walks[0]));
  return ridge;
}

bool
SlabTiler::TryCap(const Section & section, double height, bool above)
{
  if (section.hole || !section.patch.empty())
  {
    return false;
  }
  const std::size_t      mark = m_Pool.plane.size();
  const Section          ridge = RidgeOver(section, height);
  const std::vector<int> cortical(section.rings.size(), Region::Cortical);
  if (above ? TryKnit(section, ridge, cortical) : TryKnit(ridge, section, cortical))
  {
    return true;
  }
  m_Pool.Resize(mark);
  return false;
}

namespace
{
struct Segment
{
  Vector2 a, b;
};

/** Where the plane at `height` cuts the outer walls of the tetrahedra: faces with a single tetrahedron that do not lie
 * in one of the two planes. */
std::vector<Segment>
CutWalls(const VertexPool &                      pool,
         const ContourStack &                    stack,
         const std::vector<std::array<int, 3>> & faces,
         double                                  height)
{
  std::vector<Segment> segments;
  for (const auto & face : faces)
  {
    std::vector<Vector2> cut;
    for (int k = 0; k < 3; ++k)
    {
      const Vector3 & p = pool.space[face[k]];
      const Vector3 & q = pool.space[face[(k + 1) % 3]];
      const double    hp = p.dot(stack.GetNormal()) - height, hq = q.dot(stack.GetNormal()) - height;
      if ((hp < 0) != (hq < 0))
      {
        cut.push_back(stack.ToPlane(p + hp / (hp - hq) * (q - p)));
      }
    }
    if (cut.size() == 2)
    {
      segments.push_back({ cut[0], cut[1] });
    }
  }
  return segments;
}

bool
ProperlyCross(const Segment & s, const Segment & t)
{
  if (s.a.cwiseMax(s.b).x() < t.a.cwiseMin(t.b).x() || t.a.cwiseMax(t.b).x() < s.a.cwiseMin(s.b).x() ||
      s.a.cwiseMax(s.b).y() < t.a.cwiseMin(t.b).y() || t.a.cwiseMax(t.b).y() < s.a.cwiseMin(s.b).y())
  {
    return false;
  }
  const auto side = [](const Segment & u, const Vector2 & q) {
    const Vector2 d = u.b - u.a, e = q - u.a;
    const double  cross = d.x() * e.y() - d.y() * e.x();
    const double  noise = 1e-9 * (d.norm() * e.norm() + 1e-12);
    return cross > noise ? 1 : (cross < -noise ? -1 : 0);
  };
  return side(s, t.a) * side(s, t.b) < 0 && side(t, s.a) * side(t, s.b) < 0;
}
} // namespace

bool
WallsCross(const VertexPool &              pool,
           const ContourStack &            stack,
           const std::vector<TiledTetra> & tetrahedra,
           std::size_t                     begin,
           double                          lowerHeight,
           double                          upperHeight)
{
  // A face with one tetrahedron is met once; sorting brings its two uses together.
  std::vector<std::array<int, 3>> faces;
  for (std::size_t t = begin; t < tetrahedra.size(); ++t)
  {
    for (const auto & f : TetraFaces)
    {
      std::array<int, 3> face{
        { tetrahedra[t].vertices[f[0]], tetrahedra[t].vertices[f[1]], tetrahedra[t].vertices[f[2]] }
      };
      std::sort(face.begin(), face.end());
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end());
  std::vector<std::array<int, 3>> walls;
  for (std::size_t i = 0; i < faces.size(); ++i)
  {
    if ((i == 0 || faces[i] != faces[i - 1]) && (i + 1 == faces.size() || faces[i] != faces[i + 1]))
    {
      walls.push_back(faces[i]);
    }
  }
  for (const double share : { 0.15, 0.5, 0.85 })
  {
    auto segments = CutWalls(pool, stack, walls, (1 - share) * lowerHeight + share * upperHeight);
    std::sort(segments.begin(), segments.end(), [](const Segment & s, const Segment & t) {
      return std::min(s.a.x(), s.b.x()) < std::min(t.a.x(), t.b.x());
    });
    for (std::size_t i = 0; i < segments.size(); ++i)
    {
      const double end = std::max(segments[i].a.x(), segments[i].b.x());
      for (std::size_t j = i + 1; j < segments.size() && std::min(segments[j].a.x(), segments[j].b.x()) <= end; ++j)
      {
        if (ProperlyCross(segments[i], segments[j]))
        {
          return true;
        }
      }
    }
  }
  return false;
}
} // namespace tiling
} // namespace bone
