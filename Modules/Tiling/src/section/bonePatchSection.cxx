/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePatchSection.h"

#include "boneConstrainedTriangulation.h"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

namespace bone
{
namespace tiling
{
namespace
{
class PatchBuilder
{
public:
  PatchBuilder(const ContourStack & stack, const PieceOutline & piece, int slice, double height, VertexPool & pool)
    : m_Stack(stack)
    , m_Piece(piece)
    , m_Slice(slice)
    , m_Height(height)
    , m_Pool(pool)
    , m_Triangulation(Corner(-1.0), Corner(1.0))
    , m_PoolId(4, -1)
  {}

  Section
  Run(bool withAxes)
  {
    Section section;
    section.slice = m_Slice;
    for (std::size_t k = 0; k < m_Piece.loops.size(); ++k)
    {
      Walk walk = InsertLoop(static_cast<int>(k));
      if (k == 0)
      {
        section.walks.push_back(std::move(walk));
      }
      else if (m_Piece.loops[k].region == Region::Outside)
      {
        section.holes.push_back(std::move(walk));
      }
    }
    for (std::size_t i = 0; withAxes && i < m_Piece.axes.size(); ++i)
    {
      InsertAxis(m_Piece.axes[i]);
    }
    CollectTriangles(section);
    std::set<int> regions;
    for (const PlanarTriangle & triangle : section.patch)
    {
      regions.insert(triangle.region);
    }
    section.region.assign(regions.begin(), regions.end());
    return section;
  }

private:
  Vector2
  Corner(double sign) const
  {
    Vector2 low = m_Piece.loops[0].points[0], high = low;
    for (const Vector2 & q : m_Piece.loops[0].points)
    {
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
    const double margin = (high - low).norm();
    return sign < 0 ? Vector2(low.array() - margin) : Vector2(high.array() + margin);
  }

  int
  Insert(const Vector2 & q, int layer, bool mayRepeat)
  {
    const int v = m_Triangulation.Insert(q);
    if (v < static_cast<int>(m_PoolId.size()))
    {
      if (!mayRepeat)
      {
        throw std::runtime_error(PlaceOf(m_Slice, m_Piece.loops[0].id) + "contours touch");
      }
      return v;
    }
    m_PoolId.push_back(m_Pool.Add(q, m_Stack.FromPlane(q, m_Height), layer, m_Slice));
    return v;
  }

  Walk
  InsertLoop(int k)
  {
    const auto &     loop = m_Piece.loops[k];
    std::vector<int> ids;
    Walk             walk;
    for (const Vector2 & q : loop.points)
    {
      ids.push_back(Insert(q, loop.layer, false));
      walk.push_back(m_PoolId[ids.back()]);
    }
    for (std::size_t i = 0; i < ids.size(); ++i)
    {
      const int a = ids[i], b = ids[(i + 1) % ids.size()];
      m_Triangulation.Constrain(a, b);
      m_LoopOf[Undirected(a, b)] = k;
    }
    return walk;
  }

  void
  InsertAxis(const PieceOutline::Axis & axis)
  {
    int last = -1;
    for (const Vector2 & q : axis.points)
    {
      const int v = Insert(q, axis.layer, true);
      if (last >= 0 && v != last)
      {
        m_Triangulation.Constrain(last, v);
      }
      last = v;
    }
  }

  /** The triangles inside the outer contour, with the regions that the loops around them bound. */
  void
  CollectTriangles(Section & section) const
  {
    constexpr int    Unseen = -2;
    const auto &     triangles = m_Triangulation.GetTriangles();
    std::vector<int> around(triangles.size(), Unseen); // innermost loop
    std::vector<int> stack;
    for (std::size_t t = 0; t < triangles.size() && stack.empty(); ++t)
    {
      if (std::count(triangles[t].vertices.begin(), triangles[t].vertices.end(), 0) > 0)
      {
        stack.push_back(static_cast<int>(t));
        around[t] = -1;
      }
    }
    while (!stack.empty())
    {
      const int t = stack.back();
      stack.pop_back();
      for (int i = 0; i < 3; ++i)
      {
        const int u = triangles[t].neighbors[i];
        if (u < 0 || around[u] != Unseen)
        {
          continue;
        }
        const auto loop =
          m_LoopOf.find(Undirected(triangles[t].vertices[(i + 1) % 3], triangles[t].vertices[(i + 2) % 3]));
        around[u] = loop == m_LoopOf.end()      ? around[t]
                    : loop->second == around[t] ? m_Piece.loops[loop->second].parent
                                                : loop->second;
        stack.push_back(u);
      }
    }
    for (std::size_t t = 0; t < triangles.size(); ++t)
    {
      const int region = around[t] >= 0 ? m_Piece.loops[around[t]].region : static_cast<int>(Region::Outside);
      if (region != Region::Outside)
      {
        const auto & v = triangles[t].vertices;
        section.patch.push_back({ { { m_PoolId[v[0]], m_PoolId[v[1]], m_PoolId[v[2]] } }, region });
      }
    }
  }

  const ContourStack &     m_Stack;
  const PieceOutline &     m_Piece;
  int                      m_Slice;
  double                   m_Height;
  VertexPool &             m_Pool;
  ConstrainedTriangulation m_Triangulation;
  std::vector<int>         m_PoolId; ///< of each vertex of the triangulation
  std::map<Edge, int>      m_LoopOf;
};
} // namespace

Section
BuildPatch(const ContourStack & stack, const PieceOutline & piece, int slice, double height, VertexPool & pool)
{
  const std::size_t mark = pool.plane.size();
  try
  {
    return PatchBuilder(stack, piece, slice, height, pool).Run(true);
  }
  catch (const std::runtime_error &)
  {
    // Axes may lie on, or across, contours that were sampled anew; contours that do are the caller's.
    pool.Resize(mark);
    return PatchBuilder(stack, piece, slice, height, pool).Run(false);
  }
}
} // namespace tiling
} // namespace bone
