/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionBuilder.h"

#include "boneHalfwayLoop.h"
#include "bonePatchSection.h"
#include "boneRingTriangulation.h"

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
constexpr double PruneFactor = 1.0;      // significance of the axis in clearances, see SimplifyAxis
constexpr double AxisSpacing = 1.5;      // spacing along the axis in mean edges of its contour
constexpr double LeastCarriedEdge = 0.4; // of the spacing

/** Builds the walks and rings of one piece, vertices going into the pool. */
class SectionMaker
{
public:
  SectionMaker(const ContourStack & stack, int slice, double height, VertexPool & pool, const Execution & execution)
    : m_Stack(stack)
    , m_Slice(slice)
    , m_Height(height)
    , m_Pool(pool)
    , m_Execution(execution)
  {}

  Walk
  AddLoop(const std::vector<Vector2> & points, int layer)
  {
    Walk walk;
    for (const Vector2 & q : points)
    {
      walk.push_back(AddPoint(q, layer));
    }
    return walk;
  }

  /** A tree with the ring that it would have as the innermost walk. */
  struct Candidate
  {
    PlanarTree tree;
    Merge      ring;
    double     cost{ std::numeric_limits<double>::infinity() };
  };

  Candidate
  Evaluate(const PlanarTree & tree, const Section & section)
  {
    m_Execution.ThrowIfAborted();
    Candidate candidate{ tree, {} };
    if (!tree.points.empty())
    {
      const std::size_t mark = m_Pool.plane.size();
      const Walk        walk = AddTree(tree, 0);
      if (walk.size() == std::max<std::size_t>(1, 2 * tree.edges.size()))
      {
        candidate.cost = TriangulateRing(m_Pool.plane, section.walks.back(), walk, candidate.ring);
      }
      m_Pool.Resize(mark);
    }
    return candidate;
  }

  Walk
  AddTree(const PlanarTree & tree, int layer)
  {
    std::vector<int> ids;
    for (const Vector2 & q : tree.points)
    {
      ids.push_back(AddPoint(q, layer));
    }
    return TreeWalk(tree, ids);
  }

private:
  int
  AddPoint(const Vector2 & q, int layer)
  {
    return m_Pool.Add(q, m_Stack.FromPlane(q, m_Height), layer, m_Slice);
  }

  const ContourStack & m_Stack;
  int                  m_Slice;
  double               m_Height;
  VertexPool &         m_Pool;
  const Execution &    m_Execution;
};

/** The polylines of a given medial axis as one tree; without points where they are not one. */
PlanarTree
JoinAxis(const std::vector<PieceOutline::Axis> & polylines)
{
  PlanarTree                               tree;
  std::map<std::pair<double, double>, int> ids;
  const auto                               idOf = [&](const Vector2 & q) {
    const auto [it, fresh] = ids.insert({ { q.x(), q.y() }, static_cast<int>(tree.points.size()) });
    if (fresh)
    {
      tree.points.push_back(q);
    }
    return it->second;
  };
  for (const auto & [line, layer] : polylines)
  {
    for (std::size_t i = 0; i < line.size(); ++i)
    {
      const int v = idOf(line[i]);
      if (i > 0)
      {
        const int u = idOf(line[i - 1]);
        if (u != v)
        {
          tree.edges.push_back({ { u, v } });
        }
      }
    }
  }
  return tree.points.size() == tree.edges.size() + 1 ? tree : PlanarTree{};
}

double
MeanEdge(const std::vector<Vector2> & polygon)
{
  double length = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    length += (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
  }
  return length / static_cast<double>(polygon.size());
}

/** The piece's own axis: as given, else simplified from the chordal axis, else the chordal axis itself, for which a
 * triangulation always exists. */
SectionMaker::Candidate
OwnAxis(SectionMaker & maker, const PieceOutline & piece, const Section & section, TilingReport & report)
{
  const auto & loop = piece.loops.back();
  if (!piece.axes.empty())
  {
    auto given = maker.Evaluate(JoinAxis(piece.axes), section);
    if (std::isfinite(given.cost))
    {
      return given;
    }
    ++report.axesRecomputed;
    report.notes.push_back(PlaceOf(section.slice, loop.id) +
                           "the medial axis given cannot be tiled and was recomputed");
  }
  const PlanarTree chordal = ChordalAxis(loop.points);
  const double     spacing = AxisSpacing * MeanEdge(loop.points);
  for (double factor = PruneFactor; factor > 0.2; factor /= 1.6)
  {
    for (const double step : { spacing, spacing / 3 })
    {
      auto simplified = maker.Evaluate(SimplifyAxis(chordal, loop.points, factor, step), section);
      if (std::isfinite(simplified.cost))
      {
        return simplified;
      }
    }
  }
  return maker.Evaluate(chordal, section);
}

/** Adds the innermost ring about the medial axis; false where there is none. */
bool
AddAxis(SectionMaker &       maker,
        const PieceOutline & piece,
        const PlanarTree &   carried,
        double               tolerance,
        Section &            section,
        TilingReport &       report)
{
  auto best = OwnAxis(maker, piece, section, report);
  if (!std::isfinite(best.cost))
  {
    return false;
  }
  // A round piece has its point; a tree drawn together there would only be in the way.
  if (!carried.points.empty() && !(best.tree.edges.empty() && !carried.edges.empty()))
  {
    const auto & polygon = piece.loops.back().points;
    auto         candidate = maker.Evaluate(
      CarryAxis(carried, best.tree, polygon, LeastCarriedEdge * AxisSpacing * MeanEdge(polygon)), section);
    if (std::isfinite(candidate.cost) && candidate.cost <= tolerance * best.cost)
    {
      best = std::move(candidate);
    }
  }
  section.walks.push_back(maker.AddTree(best.tree, piece.loops.back().layer + 1));
  section.rings.push_back(std::move(best.ring));
  return true;
}

/** Adds the loops but for a hole; false where a ring between them cannot be triangulated. */
bool
AddLoops(SectionMaker & maker, const PieceOutline & piece, const VertexPool & pool, Section & section)
{
  for (const PieceOutline::Loop & loop : piece.loops)
  {
    if (loop.region == Region::Outside)
    {
      break;
    }
    const Walk walk = maker.AddLoop(loop.points, loop.layer);
    if (!section.walks.empty())
    {
      Merge ring;
      if (!std::isfinite(TriangulateRing(pool.plane, section.walks.back(), walk, ring)))
      {
        return false;
      }
      section.rings.push_back(std::move(ring));
    }
    section.walks.push_back(walk);
    section.region.push_back(loop.region);
  }
  return true;
}

/** Adds the two rings about the loop halfway to the hole, or, where they cannot be triangulated, one ring to the hole.
 */
bool
AddHole(SectionMaker & maker, const PieceOutline & piece, VertexPool & pool, Section & section)
{
  const Walk outer = section.walks.back();
  const Walk hole = maker.AddLoop(piece.loops.back().points, piece.loops.back().layer);
  const auto halfway = HalfwayLoop(piece.loops.front().points, piece.loops.back().points);
  Merge      inside, outside;
  section.hole = true;
  section.holes = { hole };
  if (halfway.size() > 2)
  {
    const Walk middle = maker.AddLoop(halfway, piece.loops.front().layer + 1);
    if (std::isfinite(TriangulateRing(pool.plane, outer, middle, outside)) &&
        std::isfinite(TriangulateRing(pool.plane, middle, hole, inside)))
    {
      section.walks.push_back(middle);
      section.walks.push_back(hole);
      section.rings.push_back(std::move(outside));
      section.rings.push_back(std::move(inside));
      section.region.push_back(section.region.back() + InnerHalf);
      return true;
    }
  }
  section.walks.push_back(hole);
  section.rings.emplace_back();
  return std::isfinite(TriangulateRing(pool.plane, outer, hole, section.rings.back()));
}

/** Fills in what follows from the walks of a plain piece. */
Section
Finished(Section section)
{
  section.inner.assign(section.walks.begin() + 1, section.walks.end());
  section.spurs.resize(section.rings.size());
  section.depth = static_cast<int>(section.rings.size());
  return section;
}
} // namespace

std::vector<Vector2>
OuterPolygon(const std::vector<Vector2> & plane, const Section & section)
{
  std::vector<Vector2> polygon;
  for (int v : section.walks[0])
  {
    polygon.push_back(plane[v]);
  }
  return polygon;
}

Section
BuildSection(const ContourStack & stack,
             PieceOutline         piece,
             const PlanarTree &   carried,
             double               tolerance,
             int                  slice,
             double               height,
             VertexPool &         pool,
             TilingReport &       report,
             const Execution &    execution)
{
  report.edgesRefined += RefineThinLayers(piece);
  const std::size_t mark = pool.plane.size();
  if (piece.IsChain())
  {
    SectionMaker maker(stack, slice, height, pool, execution);
    Section      section;
    section.slice = slice;
    const bool hole = piece.loops.back().region == Region::Outside;
    if (AddLoops(maker, piece, pool, section) &&
        (hole ? AddHole(maker, piece, pool, section) : AddAxis(maker, piece, carried, tolerance, section, report)))
    {
      return Finished(std::move(section));
    }
    pool.Resize(mark);
  }
  ++report.patches;
  return BuildPatch(stack, piece, slice, height, pool);
}
} // namespace tiling
} // namespace bone
