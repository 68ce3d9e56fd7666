/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabSurface.h"

#include "boneTriangleTree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace bone
{
namespace tiling
{
namespace
{
Vector3
InPlane(const Vector2 & q)
{
  return { q.x(), q.y(), 0.0 };
}

/** The contours around the regions from `layer` inward. */
TriangleTree
ContourTree(const BoxTriangulation & box, const std::vector<int> & region, int layer)
{
  std::map<Edge, bool>                sides; ///< whether the triangle met first is inside
  std::vector<TriangleTree::Triangle> segments;
  for (std::size_t t = 0; t < box.triangles.size(); ++t)
  {
    const auto & v = box.triangles[t];
    const bool   inside = region[t] >= layer;
    for (int i = 0; i < 3; ++i)
    {
      const int  a = v[i], b = v[(i + 1) % 3];
      const auto first = sides.emplace(Undirected(a, b), inside);
      if (!first.second && first.first->second != inside)
      {
        const Vector3 from = InPlane(box.points[a]), to = InPlane(box.points[b]);
        segments.push_back({ { from, to, to } });
      }
    }
  }
  return TriangleTree(std::move(segments));
}

/** The surface around the regions from `layer` inward. */
class LayerSurface
{
public:
  LayerSurface(const std::array<const BoxTriangulation *, 2> & boxes,
               const std::array<const std::vector<int> *, 2> & regions,
               const PlanarOverlay &                           overlay,
               const CutDistances &                            cuts,
               int                                             layer)
    : m_Overlay(overlay)
    , m_Cuts(cuts)
    , m_Contours{ ContourTree(*boxes[0], *regions[0], layer), ContourTree(*boxes[1], *regions[1], layer) }
  {
    for (std::size_t t = 0; t < overlay.triangles.size(); ++t)
    {
      const auto & triangle = overlay.triangles[t];
      const bool   below = (*regions[0])[triangle.first] >= layer, above = (*regions[1])[triangle.second] >= layer;
      if (below != above)
      {
        m_Triangles.push_back(static_cast<int>(t));
      }
    }
  }

  /** Height of the surface at the overlay's vertices; -1 where it does not pass between the slices. */
  std::vector<double>
  Heights()
  {
    std::vector<double> height(m_Overlay.points.size(), -1.0);
    MeasureDistances();
    JoinTriangles();
    const std::size_t                  parts = m_Triangles.size();
    std::vector<std::array<double, 2>> farthest(parts, { { 0.0, 0.0 } });
    std::vector<std::array<bool, 2>>   touches(parts, { { false, false } });
    for (std::size_t i = 0; i < parts; ++i)
    {
      const int part = Root(static_cast<int>(i));
      for (int v : m_Overlay.triangles[m_Triangles[i]].vertices)
      {
        for (int s = 0; s < 2; ++s)
        {
          farthest[part][s] = std::max(farthest[part][s], m_Distance[s][v]);
          touches[part][s] = touches[part][s] || m_Distance[s][v] == 0;
        }
      }
    }
    for (std::size_t i = 0; i < parts; ++i)
    {
      const int part = Root(static_cast<int>(i));
      for (int v : m_Overlay.triangles[m_Triangles[i]].vertices)
      {
        double below = m_Distance[0][v], above = m_Distance[1][v];
        if (!touches[part][1])
        {
          above = farthest[part][0];
        }
        else if (!touches[part][0])
        {
          below = farthest[part][1];
        }
        height[v] = below + above > 0 ? below / (below + above) : 0.5;
        if (touches[part][0] && touches[part][1])
        {
          height[v] = AtCuts(v, height[v]);
        }
      }
    }
    return height;
  }

private:
  /** The height of vertex v where a cut nearer than the contour of its slice draws the surface to that slice. */
  double
  AtCuts(int v, double height) const
  {
    const double below = std::min(m_Distance[0][v], m_Cuts[0][v]), above = std::min(m_Distance[1][v], m_Cuts[1][v]);
    const double drawn = below + above > 0 ? below / (below + above) : 0.5;
    return drawn < height ? std::min(height, std::max(drawn, LeastAtCut))
                          : std::max(height, std::min(drawn, 1.0 - LeastAtCut));
  }

  void
  MeasureDistances()
  {
    for (auto & distance : m_Distance)
    {
      distance.assign(m_Overlay.points.size(), -1.0);
    }
    for (int t : m_Triangles)
    {
      for (int v : m_Overlay.triangles[t].vertices)
      {
        for (int s = 0; s < 2 && m_Distance[s][v] < 0; ++s)
        {
          const Vector2 & q = m_Overlay.points[v];
          const auto      nearest = m_Contours[s].FindNearest(InPlane(q));
          const double    distance = std::sqrt(nearest.squaredDistance);
          m_Distance[s][v] = nearest.triangle < 0   ? std::numeric_limits<double>::max()
                             : distance > OnContour ? distance
                                                    : 0.0;
        }
      }
    }
  }

  /** Joins the triangles with common edges. */
  void
  JoinTriangles()
  {
    m_Parent.resize(m_Triangles.size());
    std::iota(m_Parent.begin(), m_Parent.end(), 0);
    std::map<Edge, int> seen;
    for (std::size_t i = 0; i < m_Triangles.size(); ++i)
    {
      const auto & v = m_Overlay.triangles[m_Triangles[i]].vertices;
      for (int k = 0; k < 3; ++k)
      {
        const auto first = seen.emplace(Undirected(v[k], v[(k + 1) % 3]), static_cast<int>(i));
        if (!first.second)
        {
          m_Parent[Root(static_cast<int>(i))] = Root(first.first->second);
        }
      }
    }
  }

  int
  Root(int i)
  {
    while (m_Parent[i] != i)
    {
      i = m_Parent[i] = m_Parent[m_Parent[i]];
    }
    return i;
  }

  static constexpr double OnContour = 1e-3; // mm, more than vertices are moved to separate them
  static constexpr double LeastAtCut = 0.1; ///< share of the slab between a surface and the slice with the cut

  const PlanarOverlay &              m_Overlay;
  const CutDistances &               m_Cuts;
  std::array<TriangleTree, 2>        m_Contours;
  std::vector<int>                   m_Triangles; ///< of the overlay, that the surface passes
  std::vector<int>                   m_Parent;    ///< of their parts
  std::array<std::vector<double>, 2> m_Distance;  ///< of overlay vertices to the slices' contours
};
} // namespace

SlabSurface
FindSlabSurface(const std::array<const BoxTriangulation *, 2> & boxes,
                const std::array<const std::vector<int> *, 2> & regions,
                const PlanarOverlay &                           overlay,
                const std::vector<Column> &                     columns,
                const CutDistances &                            cuts)
{
  const int                        points = static_cast<int>(overlay.points.size());
  const int                        planes = static_cast<int>(columns.front().size()) - 1;
  std::vector<double>              sum(static_cast<std::size_t>(points) * planes, 0.0), count = sum;
  SlabSurface                      surface;
  const int                        layers = std::max(*std::max_element(regions[0]->begin(), regions[0]->end()),
                              *std::max_element(regions[1]->begin(), regions[1]->end()));
  std::vector<std::vector<double>> heights;
  for (int layer = 1; layer <= layers; ++layer)
  {
    heights.push_back(LayerSurface(boxes, regions, overlay, cuts, layer).Heights());
  }
  for (std::size_t t = 0; t < columns.size(); ++t)
  {
    const auto & v = overlay.triangles[t].vertices;
    for (int p = 0; p < planes; ++p)
    {
      if (columns[t][p] == columns[t][p + 1])
      {
        continue;
      }
      surface.faces.push_back({ { p * points + v[0], p * points + v[1], p * points + v[2] } });
      for (int layer = 1; layer <= layers; ++layer)
      {
        if ((columns[t][p] >= layer) != (columns[t][p + 1] >= layer))
        {
          for (int k : v)
          {
            // Where pieces are separated, a surface may have no height of its own: the middle.
            sum[p * points + k] += heights[layer - 1][k] >= 0 ? heights[layer - 1][k] : (p + 1.0) / (planes + 1.0);
            count[p * points + k] += 1.0;
          }
        }
      }
    }
  }
  surface.height.assign(sum.size(), -1.0);
  for (int v = 0; v < points; ++v)
  {
    double all = 0.0, number = 0.0;
    for (int p = 0; p < planes; ++p)
    {
      all += sum[p * points + v];
      number += count[p * points + v];
    }
    for (int p = 0; p < planes && number > 0; ++p)
    {
      // A copy below or above a surface's own may still lie on its upright part.
      const int i = p * points + v;
      surface.height[i] = count[i] > 0 ? sum[i] / count[i] : all / number;
    }
  }
  return surface;
}
} // namespace tiling
} // namespace bone
