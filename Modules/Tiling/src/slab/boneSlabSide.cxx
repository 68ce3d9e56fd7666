/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabSide.h"

#include "boneConstrainedTriangulation.h"

#include <limits>
#include <map>
#include <stdexcept>

namespace bone
{
namespace tiling
{
namespace
{
constexpr int    OverlayTries = 6;
constexpr double NearPoints = 0.1;   // mm
constexpr double SpreadPoints = 0.4; // mm
constexpr double Shift = 1e-5;       // mm, separates vertices of the two slices that lie over each other

/** Whether a vertex lies inside one region and may be moved a little without turning a triangle over. */
bool
IsInner(const SlabSide & side, int vertex)
{
  int region = 0;
  for (std::size_t t = 0; t < side.box.triangles.size(); ++t)
  {
    const auto & ids = side.box.triangles[t];
    const auto   at = std::find(ids.begin(), ids.end(), vertex);
    if (at != ids.end())
    {
      if (side.region[t] == 0 || (region != 0 && side.region[t] != region))
      {
        return false;
      }
      region = side.region[t];
      const auto      i = static_cast<std::size_t>(at - ids.begin());
      const Vector2 & a = side.box.points[ids[(i + 1) % 3]];
      const Vector2 & b = side.box.points[ids[(i + 2) % 3]];
      const Vector2   x = side.box.points[vertex] - a, d = b - a;
      if ((d.x() * x.y() - d.y() * x.x()) < 4 * SpreadPoints * d.norm())
      {
        return false;
      }
    }
  }
  return region != 0;
}
} // namespace

SlabBounds
BoundsOf(const VertexPool &           pool,
         const std::vector<Section> & lower,
         const std::vector<Section> & upper,
         const Vector2 &              shift)
{
  SlabBounds bounds{ Vector2::Constant(std::numeric_limits<double>::max()),
                     Vector2::Constant(std::numeric_limits<double>::lowest()) };
  for (const auto * sections : { &lower, &upper })
  {
    for (const Section & section : *sections)
    {
      for (int v : section.walks[0])
      {
        const Vector2 q = sections == &upper ? Vector2(pool.plane[v] - shift) : pool.plane[v];
        bounds.low = bounds.low.cwiseMin(q);
        bounds.high = bounds.high.cwiseMax(q);
      }
    }
  }
  const double margin = 0.2 * (bounds.high - bounds.low).norm() + 1.0;
  bounds.low.array() -= margin;
  bounds.high.array() += margin;
  return bounds;
}

SlabSide
MakeSide(const VertexPool &           pool,
         const std::vector<Section> & sections,
         const std::vector<int> &     groupOf,
         const SlabBounds &           bounds,
         const Vector2 &              shift)
{
  SlabSide side;
  side.shift = shift;
  ConstrainedTriangulation outside(bounds.low, bounds.high);
  std::map<int, int>       local;
  side.poolId.assign(SlabSide::Corners, -1);
  for (const Section & section : sections)
  {
    std::vector<const Walk *> loops{ &section.walks[0] };
    for (const Walk & hole : section.holes)
    {
      loops.push_back(&hole);
    }
    for (const Walk * loop : loops)
    {
      for (int v : *loop)
      {
        const int id = outside.Insert(pool.plane[v] - shift);
        if (id != static_cast<int>(side.poolId.size()))
        {
          throw std::runtime_error("contours touch");
        }
        local[v] = id;
        side.poolId.push_back(v);
      }
    }
    for (const Walk * loop : loops)
    {
      for (std::size_t i = 0; i < loop->size(); ++i)
      {
        outside.Constrain(local[(*loop)[i]], local[(*loop)[(i + 1) % loop->size()]]);
      }
    }
  }
  side.box.points = outside.GetPoints();
  const std::vector<char> inside = outside.Inside();
  for (std::size_t t = 0; t < inside.size(); ++t)
  {
    if (!inside[t])
    {
      side.box.triangles.push_back(outside.GetTriangles()[t].vertices);
      side.region.push_back(0);
      side.group.push_back(-1);
      side.piece.push_back(-1);
    }
  }
  for (std::size_t s = 0; s < sections.size(); ++s)
  {
    for (const PlanarTriangle & triangle : SectionTriangles(sections[s]))
    {
      std::array<int, 3> vertices;
      for (int i = 0; i < 3; ++i)
      {
        const int  v = triangle.vertices[i];
        const auto added = local.emplace(v, static_cast<int>(side.poolId.size()));
        if (added.second)
        {
          side.poolId.push_back(v);
          side.box.points.push_back(pool.plane[v] - shift);
        }
        vertices[i] = added.first->second;
      }
      side.box.triangles.push_back(vertices);
      side.region.push_back(triangle.region);
      side.group.push_back(groupOf[s]);
      side.piece.push_back(static_cast<int>(s));
    }
  }
  return side;
}

PlanarOverlay
OverlaySides(const SlabSide & lower, const SlabSide & upper, const Execution & execution)
{
  // Medial axes of both slices often meet in nearly the same point, whose fans of triangles would cross each other in a
  // knot of that size.
  BoxTriangulation spread = upper.box;
  for (std::size_t v = SlabSide::Corners; v < spread.points.size(); ++v)
  {
    const bool near =
      std::any_of(lower.box.points.begin() + SlabSide::Corners, lower.box.points.end(), [&](const Vector2 & q) {
        return (q - upper.box.points[v]).squaredNorm() < NearPoints * NearPoints;
      });
    if (near && IsInner(upper, static_cast<int>(v)))
    {
      spread.points[v] += SpreadPoints * Vector2(0.8, 0.6);
    }
  }
  for (int attempt = 1;; ++attempt)
  {
    BoxTriangulation moved = spread;
    for (std::size_t v = SlabSide::Corners; v < moved.points.size(); ++v)
    {
      // No two vertices by the same amount, lest edges of both slices stay collinear.
      const double angle = 2.399963 * static_cast<double>(v) * attempt;
      moved.points[v] += Shift * attempt * Vector2(1.0 + 0.3 * std::cos(angle), 0.618 + 0.3 * std::sin(angle));
    }
    try
    {
      return Overlay(lower.box, moved, execution);
    }
    catch (const std::runtime_error &)
    {
      if (attempt >= OverlayTries)
      {
        throw;
      }
    }
  }
}
} // namespace tiling
} // namespace bone
