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
} // namespace tiling
} // namespace bone
