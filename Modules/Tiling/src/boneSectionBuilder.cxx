/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSectionBuilder.h"

#include "boneOutlineInterpolation.h"
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
constexpr int    RefinementRounds = 3;
constexpr double LeastEdge = 0.6; // mm; shorter edges are not split

double
Distance(const Vector2 & q, const std::vector<Vector2> & polygon)
{
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vector2 & a = polygon[i];
    const Vector2   d = polygon[(i + 1) % polygon.size()] - a;
    const double    t = std::clamp((q - a).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
    best = std::min(best, (q - a - t * d).norm());
  }
  return best;
}

std::string
Place(std::size_t slice, int id)
{
  return "slice " + std::to_string(slice) + ", contour " + std::to_string(id) + ": ";
}

/** Splits the edges of `polygon` that are longer than twice the distance of their middle to `other`. */
int
RefineAgainst(std::vector<Vector2> & polygon, const std::vector<Vector2> & other)
{
  std::vector<Vector2> refined;
  int                  added = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vector2 & a = polygon[i];
    const Vector2 & b = polygon[(i + 1) % polygon.size()];
    const Vector2   middle = 0.5 * (a + b);
    refined.push_back(a);
    if ((b - a).norm() > std::max(2 * LeastEdge, 3.0 * Distance(middle, other)))
    {
      refined.push_back(middle);
      ++added;
    }
  }
  polygon = std::move(refined);
  return added;
}

/** Builds the walks and rings of one piece, vertices going into the pool. */
class SectionMaker
{
public:
  SectionMaker(const ContourStack & stack, int slice, double height, VertexPool & pool)
    : m_Stack(stack)
    , m_Slice(slice)
    , m_Height(height)
    , m_Pool(pool)
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
};

/** The polylines of a given medial axis as one tree; without points where they are not one. */
PlanarTree
JoinAxis(const std::vector<std::vector<Vector2>> & polylines)
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
  for (const auto & line : polylines)
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
  if (!piece.axis.empty())
  {
    auto given = maker.Evaluate(JoinAxis(piece.axis), section);
    if (std::isfinite(given.cost))
    {
      return given;
    }
    ++report.axesRecomputed;
    report.notes.push_back(Place(section.slice, loop.id) + "the medial axis given cannot be tiled and was recomputed");
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

/** Adds the inner loops; false where a ring cannot be triangulated, `failed` then being the index of its inner loop. */
bool
AddLoops(SectionMaker &       maker,
         const PieceOutline & piece,
         const VertexPool &   pool,
         Section &            section,
         std::size_t &        failed)
{
  for (std::size_t k = 0; k < piece.loops.size(); ++k)
  {
    const Walk walk = maker.AddLoop(piece.loops[k].points, piece.loops[k].layer);
    if (k > 0)
    {
      Merge ring;
      if (!std::isfinite(TriangulateRing(pool.plane, section.walks.back(), walk, ring)))
      {
        failed = k;
        return false;
      }
      section.rings.push_back(std::move(ring));
    }
    section.walks.push_back(walk);
    section.region.push_back(piece.loops[k].region);
  }
  return true;
}
} // namespace

std::vector<PieceOutline>
CollectPieces(const ContourStack & stack, std::size_t slice, TilingReport & report)
{
  std::vector<PieceOutline>       pieces;
  std::vector<PieceOutline::Loop> inner;
  std::vector<PieceOutline::Loop> holes;
  std::vector<const Contour *>    axes;
  for (const Contour & contour : stack.GetSlices()[slice].contours)
  {
    if (contour.axis)
    {
      axes.push_back(&contour);
      continue;
    }
    PieceOutline::Loop loop;
    for (const Vector3 & p : contour.points)
    {
      loop.points.push_back(stack.ToPlane(p));
    }
    if (SignedArea(loop.points) < 0)
    {
      std::reverse(loop.points.begin(), loop.points.end());
    }
    loop.layer = contour.layer;
    loop.region = contour.region;
    loop.id = contour.id;
    if (loop.region == Region::Outside)
    {
      holes.push_back(std::move(loop));
    }
    else if (loop.layer == 0)
    {
      pieces.emplace_back();
      pieces.back().loops.push_back(std::move(loop));
    }
    else
    {
      inner.push_back(std::move(loop));
    }
  }
  const auto owner = [&pieces](const Vector2 & q) -> PieceOutline * {
    for (PieceOutline & piece : pieces)
    {
      if (PointInPolygon(q, piece.loops.front().points))
      {
        return &piece;
      }
    }
    return nullptr;
  };
  for (auto & hole : holes)
  {
    PieceOutline * piece = owner(hole.points.front());
    if (piece == nullptr || std::abs(SignedArea(hole.points)) <= std::abs(SignedArea(piece->hole)))
    {
      ++report.holesLeftOut;
      report.notes.push_back(Place(slice, hole.id) + "hole left out, one hole a piece is tiled");
      continue;
    }
    if (!piece->hole.empty())
    {
      ++report.holesLeftOut;
      report.notes.push_back(Place(slice, hole.id) + "took the place of a smaller hole of the same piece");
    }
    piece->hole = hole.points;
  }
  // Larger loops first within a layer, so that the largest of each layer is the one that is kept.
  std::stable_sort(inner.begin(), inner.end(), [](const PieceOutline::Loop & a, const PieceOutline::Loop & b) {
    return a.layer != b.layer ? a.layer < b.layer : SignedArea(a.points) > SignedArea(b.points);
  });
  for (auto & loop : inner)
  {
    PieceOutline * piece = owner(loop.points.front());
    if (piece == nullptr || !piece->hole.empty() || loop.layer <= piece->loops.back().layer ||
        loop.region <= piece->loops.back().region || !PointInPolygon(loop.points.front(), piece->loops.back().points))
    {
      ++report.loopsLeftOut;
      report.notes.push_back(Place(slice, loop.id) + "inner contour left out, one a layer and piece is tiled");
      continue;
    }
    piece->loops.push_back(std::move(loop));
  }
  for (const Contour * axis : axes)
  {
    std::vector<Vector2> line;
    for (const Vector3 & p : axis->points)
    {
      line.push_back(stack.ToPlane(p));
    }
    PieceOutline * piece = line.empty() ? nullptr : owner(line.front());
    if (piece != nullptr && axis->layer == piece->loops.back().layer + 1 &&
        PointInPolygon(line.front(), piece->loops.back().points))
    {
      piece->axis.push_back(std::move(line));
    }
  }
  return pieces;
}

namespace
{
/** Adds the two rings about the loop halfway to the hole, or, where they cannot be triangulated, one ring to the hole.
 */
bool
AddHole(SectionMaker & maker, const PieceOutline & piece, VertexPool & pool, Section & section)
{
  const Walk outer = section.walks.back();
  const Walk hole = maker.AddLoop(piece.hole, 0);
  const auto halfway = HalfwayLoop(piece.loops.back().points, piece.hole);
  Merge      inside, outside;
  section.hole = true;
  if (halfway.size() > 2)
  {
    const Walk middle = maker.AddLoop(halfway, piece.loops.back().layer + 1);
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
             TilingReport &       report)
{
  for (int round = 0; round < RefinementRounds; ++round)
  {
    int added = 0;
    for (std::size_t k = 1; k < piece.loops.size(); ++k)
    {
      added += RefineAgainst(piece.loops[k - 1].points, piece.loops[k].points);
      added += RefineAgainst(piece.loops[k].points, piece.loops[k - 1].points);
    }
    if (!piece.hole.empty())
    {
      added += RefineAgainst(piece.loops.back().points, piece.hole);
      added += RefineAgainst(piece.hole, piece.loops.back().points);
    }
    report.edgesRefined += added;
    if (added == 0)
    {
      break;
    }
  }
  SectionMaker      maker(stack, slice, height, pool);
  const std::size_t mark = pool.plane.size();
  for (;;)
  {
    Section section;
    section.slice = slice;
    std::size_t failed = 0;
    if (!AddLoops(maker, piece, pool, section, failed))
    {
      pool.Resize(mark);
      ++report.loopsLeftOut;
      report.notes.push_back(Place(slice, piece.loops[failed].id) +
                             "inner contour left out, the layer outside it cannot be triangulated");
      piece.loops.erase(piece.loops.begin() + static_cast<std::ptrdiff_t>(failed));
      piece.axis.clear();
      continue;
    }
    if (!piece.hole.empty())
    {
      if (AddHole(maker, piece, pool, section))
      {
        return Finished(std::move(section));
      }
      pool.Resize(mark);
      ++report.holesLeftOut;
      report.notes.push_back(Place(slice, piece.loops.front().id) +
                             "its hole was closed, the ring cannot be triangulated");
      piece.hole.clear();
      continue;
    }
    if (AddAxis(maker, piece, carried, tolerance, section, report))
    {
      return Finished(std::move(section));
    }
    throw std::runtime_error(Place(slice, piece.loops.back().id) +
                             "cannot be triangulated; does the contour cross itself?");
  }
}
} // namespace tiling
} // namespace bone
