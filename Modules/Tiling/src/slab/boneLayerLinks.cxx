/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLayerLinks.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace bone
{
namespace tiling
{
namespace
{
double
AreaOf(const std::vector<Vector2> & points, const std::array<int, 3> & v)
{
  const Vector2 d = points[v[1]] - points[v[0]], e = points[v[2]] - points[v[0]];
  return 0.5 * (d.x() * e.y() - d.y() * e.x());
}

/** The parts of a slice's regions from `layer` inward, or of all others. */
class LayerParts
{
public:
  LayerParts(const BoxTriangulation & box, const std::vector<int> & region, int layer, bool inner)
    : m_Root(box.triangles.size())
    , m_Area(box.triangles.size(), 0.0)
    , m_Vertex(box.triangles.size(), static_cast<int>(box.points.size()))
  {
    std::iota(m_Root.begin(), m_Root.end(), 0);
    std::map<Edge, int> seen;
    for (std::size_t t = 0; t < box.triangles.size(); ++t)
    {
      const auto & v = box.triangles[t];
      for (int i = 0; i < 3 && (region[t] >= layer) == inner; ++i)
      {
        const int  a = v[i], b = v[(i + 1) % 3];
        const auto first = seen.emplace(Undirected(a, b), static_cast<int>(t));
        if (!first.second)
        {
          const int one = this->Of(static_cast<int>(t)), other = this->Of(first.first->second);
          m_Root[std::max(one, other)] = std::min(one, other);
        }
      }
    }
    for (std::size_t t = 0; t < box.triangles.size(); ++t)
    {
      const auto & v = box.triangles[t];
      const int    part = this->Of(static_cast<int>(t));
      m_Area[part] += AreaOf(box.points, v);
      m_Vertex[part] = std::min({ m_Vertex[part], v[0], v[1], v[2] });
    }
  }

  int
  Of(int triangle)
  {
    while (m_Root[triangle] != triangle)
    {
      triangle = m_Root[triangle] = m_Root[m_Root[triangle]];
    }
    return triangle;
  }

  double
  Area(int part) const
  {
    return m_Area[part];
  }

  int
  FirstVertex(int part) const
  {
    return m_Vertex[part];
  }

private:
  std::vector<int>    m_Root;
  std::vector<double> m_Area; ///< of each part, at its first triangle
  std::vector<int>    m_Vertex;
};
} // namespace

std::set<LayerLink>
FindLayerLinks(const std::array<const BoxTriangulation *, 2> & boxes,
               const std::array<const std::vector<int> *, 2> & regions,
               const std::array<const std::vector<int> *, 2> & groups,
               const PlanarOverlay &                           overlay,
               double                                          share)
{
  std::set<LayerLink> links;
  const int           layers = std::min(*std::max_element(regions[0]->begin(), regions[0]->end()),
                              *std::max_element(regions[1]->begin(), regions[1]->end()));
  for (const bool inner : { true, false })
  {
    for (int layer = 1; layer <= layers; ++layer)
    {
      LayerParts below(*boxes[0], *regions[0], layer, inner), above(*boxes[1], *regions[1], layer, inner);
      std::map<LayerLink, double> common;
      for (const auto & t : overlay.triangles)
      {
        const bool in = (*regions[0])[t.first] >= layer, alike = in == ((*regions[1])[t.second] >= layer);
        if (alike && in == inner && (!inner || (*groups[0])[t.first] == (*groups[1])[t.second]))
        {
          common[{ { inner ? layer : -layer, below.Of(t.first), above.Of(t.second) } }] +=
            AreaOf(overlay.points, t.vertices);
        }
      }
      for (const auto & [link, area] : common)
      {
        if (area > share * std::min(below.Area(link[1]), above.Area(link[2])))
        {
          links.insert({ { link[0], below.FirstVertex(link[1]), above.FirstVertex(link[2]) } });
        }
      }
    }
  }
  return links;
}
} // namespace tiling
} // namespace bone
