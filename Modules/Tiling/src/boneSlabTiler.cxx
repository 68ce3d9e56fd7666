/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabTiler.h"

#include "boneOutlineInterpolation.h"
#include "bonePredicates.h"
#include "boneRingTriangulation.h"
#include "boneSectionJoin.h"
#include "boneWallMerge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace tiling
{
namespace
{
constexpr int KnitBudget = 60;         // ring knits tried before another way is taken
constexpr int MaximumDepth = 3;        // halvings of a slab by planes in between
constexpr int LayeredPlaneBudget = 14; // planes in between tried for one slab; without layers there is no other way
constexpr int PlainPlaneBudget = 60;

std::vector<std::vector<Vector2>>
OuterPolygons(const std::vector<Vector2> & plane, const std::vector<Section> & sections)
{
  std::vector<std::vector<Vector2>> polygons;
  for (const Section & section : sections)
  {
    polygons.push_back(OuterPolygon(plane, section));
  }
  return polygons;
}

std::vector<Section>
Pick(const std::vector<Section> & sections, const std::vector<int> & ids)
{
  std::vector<Section> picked;
  for (int i : ids)
  {
    picked.push_back(sections[i]);
  }
  return picked;
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
  const RingPair rings{ lower.walks[ring], lower.inner[ring], lower.rings[ring],
                        upper.walks[ring], upper.inner[ring], upper.rings[ring] };
  const Merge    inner = WithSpurs(m_Pool.plane, lower, upper, ring, wall);
  bool           more = true;
  for (int start = 0; more; ++start)
  {
    if (budget-- <= 0)
    {
      return false;
    }
    const std::size_t mark = m_Tetrahedra.size();
    Merge             outer;
    if (KnitRing(m_Pool, rings, inner, m_Metric, start, RegionOfSlot(regions[ring]), outer, m_Tetrahedra, more) &&
        (ring == 0 || KnitFrom(lower, upper, ring - 1, outer, regions, budget)))
    {
      return true;
    }
    m_Tetrahedra.resize(mark);
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
      if (!WallsCross(m_Pool,
                      m_Stack,
                      m_Tetrahedra,
                      mark,
                      m_Pool.space[lower.walks[0][0]].dot(m_Stack.GetNormal()),
                      m_Pool.space[upper.walks[0][0]].dot(m_Stack.GetNormal())))
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
      !TryKnit(below, above, RingRegions(below, above)))
  {
    return false;
  }
  m_UsedEdges = used;
  MarkCollapsed(below);
  MarkCollapsed(above);
  return true;
}

void
SlabTiler::TileGroup(const std::vector<Section> & lower,
                     const std::vector<Section> & upper,
                     double                       lowerHeight,
                     double                       upperHeight,
                     int                          depth)
{
  if (depth == 0)
  {
    m_Budget = RegionsOf(lower).size() + RegionsOf(upper).size() > 2 ? LayeredPlaneBudget : PlainPlaneBudget;
  }
  if (TryDirect(lower, upper))
  {
    return;
  }
  if (TryIntermediate(lower, upper, lowerHeight, upperHeight, depth))
  {
    return;
  }
  const std::string place = "slice " + std::to_string(lower.front().slice) + ", piece of " +
                            std::to_string(lower.front().walks[0].size()) + " points at (" +
                            std::to_string(m_Pool.plane[lower.front().walks[0][0]].x()) + ", " +
                            std::to_string(m_Pool.plane[lower.front().walks[0][0]].y()) + ") mm in the plane";
  if (TryStar(lower, upper, 0.5 * (lowerHeight + upperHeight)))
  {
    ++m_Report.starFillings;
    m_Report.notes.push_back(place + ": the slab above was filled from one interior vertex");
    return;
  }
  throw std::runtime_error(place + ": the space to the next slice cannot be filled with valid tetrahedra; "
                                   "use a smaller slice step or contour spacing");
}

void
SlabTiler::MarkCollapsed(const Section & section)
{
  if (section.depth < static_cast<int>(section.rings.size()))
  {
    m_Collapsed.insert(section.walks.back().begin(), section.walks.back().end());
  }
}

std::vector<int>
SlabTiler::RingRegions(const Section & lower, const Section & upper) const
{
  std::vector<int> regions = lower.region;
  for (const Section * section : { &lower, &upper })
  {
    const Walk & walk = section->walks.back();
    if (std::any_of(walk.begin(), walk.end(), [this](int v) { return m_Collapsed.count(v) > 0; }))
    {
      for (std::size_t k = static_cast<std::size_t>(section->depth); k < regions.size(); ++k)
      {
        regions[k] = regions[k - 1];
      }
    }
  }
  return regions;
}

bool
SlabTiler::TryIntermediate(const std::vector<Section> & lower,
                           const std::vector<Section> & upper,
                           double                       lowerHeight,
                           double                       upperHeight,
                           int                          depth)
{
  if (depth >= MaximumDepth)
  {
    return false;
  }
  // The plane in between takes on the axis from below, or from above, or has one of its own; at last it does without
  // inner layers.
  const auto                    outlines = InterpolateOutlines(m_Pool.plane, m_Pool.layer, lower, upper);
  const std::vector<PlanarTree> axes{ AxisOf(lower), AxisOf(upper), PlanarTree{} };
  for (const bool layered : { true, false })
  {
    auto pieces = outlines;
    for (PieceOutline & piece : pieces)
    {
      piece.loops.resize(layered ? piece.loops.size() : 1);
    }
    for (const PlanarTree & axis : axes)
    {
      if (m_Budget-- <= 0)
      {
        return false;
      }
      if (TryPlane(lower, upper, lowerHeight, upperHeight, depth, pieces, axis))
      {
        ++m_Report.intermediateSlices;
        return true;
      }
    }
  }
  return false;
}

bool
SlabTiler::TryPlane(const std::vector<Section> &      lower,
                    const std::vector<Section> &      upper,
                    double                            lowerHeight,
                    double                            upperHeight,
                    int                               depth,
                    const std::vector<PieceOutline> & pieces,
                    const PlanarTree &                axis)
{
  const std::size_t  tetraMark = m_Tetrahedra.size(), poolMark = m_Pool.plane.size();
  const TilingReport reportMark = m_Report;
  const EdgeSet      usedMark = m_UsedEdges;
  const double       height = 0.5 * (lowerHeight + upperHeight);
  try
  {
    std::vector<Section> middle;
    for (const PieceOutline & piece : pieces)
    {
      middle.push_back(BuildSection(
        m_Stack, piece, axis, std::numeric_limits<double>::max(), lower.front().slice, height, m_Pool, m_Report));
    }
    const auto connect = [&](const std::vector<Section> & a, const std::vector<Section> & b, double ha, double hb) {
      const std::size_t begin = m_Tetrahedra.size();
      for (const Group & group : MatchPieces(OuterPolygons(m_Pool.plane, a), OuterPolygons(m_Pool.plane, b), hb - ha))
      {
        if (group.lower.empty() || group.upper.empty())
        {
          throw std::runtime_error("a piece lost its counterpart");
        }
        TileGroup(Pick(a, group.lower), Pick(b, group.upper), ha, hb, depth + 1);
      }
      if (WallsCross(m_Pool, m_Stack, m_Tetrahedra, begin, ha, hb))
      {
        throw std::runtime_error("surfaces cross");
      }
    };
    if (!middle.empty())
    {
      connect(lower, middle, lowerHeight, height);
      connect(middle, upper, height, upperHeight);
      return true;
    }
  }
  catch (const std::runtime_error &)
  {
    // This way failed; the caller goes on to the next one.
  }
  m_Tetrahedra.resize(tetraMark);
  m_Pool.Resize(poolMark);
  m_Report = reportMark;
  m_UsedEdges = usedMark;
  return false;
}

PlanarTree
SlabTiler::AxisOf(const std::vector<Section> & sections) const
{
  Section composite;
  EdgeSet used;
  return Compose(m_Pool.plane, sections, RegionsOf(sections), used, composite) && !composite.hole
           ? TreeOfWalk(m_Pool.plane, composite.walks.back())
           : PlanarTree{};
}

void
SlabTiler::AddWallCells(const Walk & lower, const Walk & upper, const Merge & wall, int apex)
{
  int i = wall.first, j = wall.second;
  for (std::uint8_t letter : wall.letters)
  {
    const int a = lower[i % lower.size()], c = upper[j % upper.size()];
    (letter == 0 ? i : j) += 1;
    const int next = letter == 0 ? lower[i % lower.size()] : upper[j % upper.size()];
    if (a != next && c != next)
    {
      m_Tetrahedra.push_back({ { { a, next, apex, c } }, Region::Cortical });
    }
  }
}

bool
SlabTiler::TryStar(const std::vector<Section> & lowers, const std::vector<Section> & uppers, double height)
{
  if (lowers.size() > 1 || uppers.size() > 1 || lowers.front().hole || uppers.front().hole)
  {
    return false;
  }
  const Section &      lower = lowers.front();
  const Section &      upper = uppers.front();
  std::vector<Vector2> centres;
  for (const Section * section : { &lower, &upper })
  {
    for (int v : section->walks.back())
    {
      centres.push_back(m_Pool.plane[v]);
    }
  }
  Merge wall;
  for (int variant = 0; MergeClosedWalks(m_Pool.plane, lower.walks[0], upper.walks[0], variant, wall); ++variant)
  {
    for (const Vector2 & centre : centres)
    {
      const std::size_t mark = m_Tetrahedra.size();
      const int         p =
        m_Pool.Add(centre, m_Stack.FromPlane(centre, height), static_cast<int>(lower.region.size()), lower.slice);
      for (const PlanarTriangle & t : SectionTriangles(lower))
      {
        m_Tetrahedra.push_back({ { { t.vertices[0], t.vertices[1], t.vertices[2], p } }, Region::Cortical });
      }
      for (const PlanarTriangle & t : SectionTriangles(upper))
      {
        m_Tetrahedra.push_back({ { { t.vertices[0], t.vertices[2], t.vertices[1], p } }, Region::Cortical });
      }
      AddWallCells(lower.walks[0], upper.walks[0], wall, p);
      const bool valid = std::all_of(
        m_Tetrahedra.begin() + static_cast<std::ptrdiff_t>(mark), m_Tetrahedra.end(), [&](const TiledTetra & t) {
          return Orient3D(m_Pool.space[t.vertices[0]],
                          m_Pool.space[t.vertices[1]],
                          m_Pool.space[t.vertices[2]],
                          m_Pool.space[t.vertices[3]]) > 0;
        });
      if (valid)
      {
        return true;
      }
      m_Tetrahedra.resize(mark);
      m_Pool.Resize(m_Pool.plane.size() - 1);
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

void
SlabTiler::Cap(const Section & section, double height, bool above)
{
  if (section.hole)
  {
    ++m_Report.flatCuts;
    m_Report.notes.push_back("slice " + std::to_string(section.slice) + ": an end with a hole was left flat");
    return;
  }
  ++m_Report.caps;
  const std::size_t      mark = m_Pool.plane.size();
  const Section          ridge = RidgeOver(section, height);
  const std::vector<int> cortical(section.rings.size(), Region::Cortical);
  if (above ? TryKnit(section, ridge, cortical) : TryKnit(ridge, section, cortical))
  {
    return;
  }
  const Vector2 apex = m_Pool.plane[ridge.walks[0][ridge.walks[0].size() / 4]];
  m_Pool.Resize(mark);
  CapByCone(section, apex, height, above);
}

void
SlabTiler::CapByCone(const Section & section, const Vector2 & apex, double height, bool above)
{
  const int v = m_Pool.Add(apex, m_Stack.FromPlane(apex, height), 0, section.slice);
  for (const PlanarTriangle & t : SectionTriangles(section))
  {
    const int b = above ? t.vertices[1] : t.vertices[2], c = above ? t.vertices[2] : t.vertices[1];
    m_Tetrahedra.push_back({ { { t.vertices[0], b, c, v } }, Region::Cortical });
  }
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
