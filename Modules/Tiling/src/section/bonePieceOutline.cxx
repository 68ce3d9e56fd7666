/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePieceOutline.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace tiling
{
namespace
{
constexpr int    RefinementRounds = 3;
constexpr double LeastEdge = 0.6; // mm; shorter edges are not split
constexpr double LongEdge = 8.0;  // of the distance to the other loop

using Loop = PieceOutline::Loop;

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
    if ((b - a).norm() > std::max(2 * LeastEdge, LongEdge * Distance(middle, other)))
    {
      refined.push_back(middle);
      ++added;
    }
  }
  polygon = std::move(refined);
  return added;
}

std::vector<Vector2>
InPlane(const ContourStack & stack, const std::vector<Vector3> & points)
{
  std::vector<Vector2> line;
  for (const Vector3 & p : points)
  {
    line.push_back(stack.ToPlane(p));
  }
  return line;
}

/** Closed contours of a slice, the larger ones first, so that each comes after all around it. */
std::vector<Loop>
ClosedContours(const ContourStack & stack, std::size_t slice)
{
  std::vector<std::pair<double, Loop>> loops;
  for (const Contour & contour : stack.GetSlices()[slice].contours)
  {
    if (!contour.axis)
    {
      Loop         loop{ InPlane(stack, contour.points), contour.layer, contour.region, contour.id, -1 };
      const double area = SignedArea(loop.points);
      if (area < 0)
      {
        std::reverse(loop.points.begin(), loop.points.end());
      }
      loops.emplace_back(std::abs(area), std::move(loop));
    }
  }
  std::stable_sort(loops.begin(), loops.end(), [](const auto & a, const auto & b) { return a.first > b.first; });
  std::vector<Loop> sorted;
  for (auto & loop : loops)
  {
    sorted.push_back(std::move(loop.second));
  }
  return sorted;
}

/** Position of the innermost loop of a piece around q; -1 where q is outside. */
int
InnermostAround(const PieceOutline & piece, const Vector2 & q)
{
  int innermost = -1;
  for (std::size_t k = 0; k < piece.loops.size(); ++k)
  {
    if (piece.loops[k].parent == innermost && PointInPolygon(q, piece.loops[k].points))
    {
      innermost = static_cast<int>(k);
    }
  }
  return innermost;
}
} // namespace

bool
PieceOutline::IsChain() const
{
  for (std::size_t k = 1; k < loops.size(); ++k)
  {
    const bool hole = loops[k].region == Region::Outside;
    if (loops[k].parent != static_cast<int>(k) - 1 || (hole && loops.size() > 2) ||
        (!hole && loops[k].region <= loops[k - 1].region))
    {
      return false;
    }
  }
  return true;
}

std::string
PlaceOf(std::size_t slice, int contour)
{
  return "slice " + std::to_string(slice) + ", contour " + std::to_string(contour) + ": ";
}

std::vector<PieceOutline>
CollectPieces(const ContourStack & stack, std::size_t slice, const std::set<int> & closed, TilingReport & report)
{
  std::vector<PieceOutline> pieces;
  for (Loop & loop : ClosedContours(stack, slice))
  {
    if (loop.region == Region::Outside && closed.count(loop.id) > 0)
    {
      ++report.holesLeftOut;
      report.notes.push_back(PlaceOf(slice, loop.id) + "closed, it is bone above and below this hole");
      continue;
    }
    // The piece whose bone, or hole, is around the loop; pieces in holes come after those around them.
    PieceOutline * piece = nullptr;
    for (PieceOutline & candidate : pieces)
    {
      const int parent = InnermostAround(candidate, loop.points.front());
      if (parent >= 0)
      {
        piece = &candidate;
        loop.parent = parent;
      }
    }
    const int around = piece != nullptr ? piece->loops[loop.parent].region : static_cast<int>(Region::Outside);
    if (around == loop.region)
    {
      ++(loop.region == Region::Outside ? report.holesLeftOut : report.loopsLeftOut);
      report.notes.push_back(PlaceOf(slice, loop.id) + "left out, it lies in what it bounds");
    }
    else if (around == Region::Outside)
    {
      loop.parent = -1;
      pieces.emplace_back();
      pieces.back().loops.push_back(std::move(loop));
    }
    else
    {
      piece->loops.push_back(std::move(loop));
    }
  }
  for (const Contour & contour : stack.GetSlices()[slice].contours)
  {
    if (contour.axis && !contour.points.empty())
    {
      const auto line = InPlane(stack, contour.points);
      for (PieceOutline & piece : pieces)
      {
        const int innermost = InnermostAround(piece, line.front());
        if (innermost >= 0 && piece.loops[innermost].region != Region::Outside &&
            contour.layer == piece.loops[innermost].layer + 1)
        {
          piece.axes.push_back({ line, contour.layer });
        }
      }
    }
  }
  return pieces;
}

int
RefineThinLayers(PieceOutline & piece)
{
  int added = 0;
  for (int round = 0; round < RefinementRounds; ++round)
  {
    int now = 0;
    for (std::size_t k = 1; k < piece.loops.size(); ++k)
    {
      Loop & parent = piece.loops[piece.loops[k].parent];
      now += RefineAgainst(parent.points, piece.loops[k].points);
      now += RefineAgainst(piece.loops[k].points, parent.points);
    }
    added += now;
    if (now == 0)
    {
      break;
    }
  }
  return added;
}
} // namespace tiling
} // namespace bone
