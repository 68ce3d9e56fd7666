/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFacetFit.h"

#include <array>

namespace bone
{
namespace
{
/** Places on a facet and their weights: exact for cubic polynomials. */
struct FacetNode
{
  Vector3 share;
  double  weight;
};

const std::array<FacetNode, 7> &
FacetNodes()
{
  static const std::array<FacetNode, 7> nodes = { {
    { Vector3(1, 0, 0), 1.0 / 20 },
    { Vector3(0, 1, 0), 1.0 / 20 },
    { Vector3(0, 0, 1), 1.0 / 20 },
    { Vector3(0.5, 0.5, 0), 2.0 / 15 },
    { Vector3(0, 0.5, 0.5), 2.0 / 15 },
    { Vector3(0.5, 0, 0.5), 2.0 / 15 },
    { Vector3::Constant(1.0 / 3), 9.0 / 20 },
  } };
  return nodes;
}

/** How far each facet's three vertices are asked to move outward, and with which weight. */
struct FacetPull
{
  Vector3 move{ Vector3::Zero() };
  Vector3 weight{ Vector3::Zero() };
};

FacetPull
FindPull(const TriangleSurface &      surface,
         std::size_t                  facet,
         const std::vector<Vector3> & normals,
         const DirectedSurface &      target,
         double                       reach)
{
  const auto &    t = surface.triangles[facet];
  const Vector3 & a = surface.points[t[0]];
  const Vector3 & b = surface.points[t[1]];
  const Vector3 & c = surface.points[t[2]];
  const Vector3   across = (b - a).cross(c - a);
  FacetPull       pull;
  for (const FacetNode & node : FacetNodes())
  {
    const Vector3 & w = node.share;
    const Vector3   x = w[0] * a + w[1] * b + w[2] * c;
    const Vector3   normal = (w[0] * normals[t[0]] + w[1] * normals[t[1]] + w[2] * normals[t[2]]).normalized();
    const auto      match = target.Find(x, normal);
    if (match.triangle >= 0 && match.squaredDistance <= reach * reach)
    {
      const Vector3 weight = node.weight * across.norm() * w;
      pull.move += weight * (match.point - x).dot(normal);
      pull.weight += weight;
    }
  }
  return pull;
}

/** How far each vertex is asked to move outward; 0 where nothing is near. */
std::vector<double>
FindMoves(const TriangleSurface &      surface,
          const std::vector<Vector3> & normals,
          const DirectedSurface &      target,
          double                       reach,
          const Execution &            execution)
{
  std::vector<FacetPull> pulls(surface.triangles.size());
  execution.Silent().For(
    pulls.size(), [&](std::size_t f) { pulls[f] = FindPull(surface, f, normals, target, reach); }, 64);
  std::vector<double> move(surface.points.size(), 0.0), weight(surface.points.size(), 0.0);
  for (std::size_t f = 0; f < pulls.size(); ++f)
  {
    for (int i = 0; i < 3; ++i)
    {
      move[surface.triangles[f][i]] += pulls[f].move[i];
      weight[surface.triangles[f][i]] += pulls[f].weight[i];
    }
  }
  for (std::size_t v = 0; v < move.size(); ++v)
  {
    move[v] = weight[v] > 0 ? move[v] / weight[v] : 0.0;
  }
  return move;
}

/** Averages of each vertex's and its neighbours' values; along the two edges of each triangle that meet there. */
void
AverageOnce(const TriangleSurface & surface, std::vector<double> & values)
{
  std::vector<double> sum(values), count(values.size(), 1.0);
  for (const auto & t : surface.triangles)
  {
    for (int i = 0; i < 3; ++i)
    {
      sum[t[i]] += 0.5 * (values[t[(i + 1) % 3]] + values[t[(i + 2) % 3]]);
      count[t[i]] += 1.0;
    }
  }
  for (std::size_t v = 0; v < values.size(); ++v)
  {
    values[v] = sum[v] / count[v];
  }
}
} // namespace

void
FitFacets(TriangleSurface &          surface,
          const DirectedSurface &    target,
          const FacetFitParameters & parameters,
          const std::vector<char> &  fixed,
          const Execution &          execution)
{
  const std::vector<Vector3> before = surface.points;
  for (const int averages : parameters.smoothing)
  {
    const std::vector<Vector3> normals = PointNormals(surface);
    std::vector<double>        move = FindMoves(surface, normals, target, parameters.reach, execution);
    for (int i = 0; i < averages; ++i)
    {
      AverageOnce(surface, move);
    }
    for (std::size_t v = 0; v < surface.points.size(); ++v)
    {
      if (fixed.empty() || fixed[v] == 0)
      {
        const Vector3 moved = surface.points[v] + move[v] * normals[v] - before[v];
        surface.points[v] =
          before[v] + moved * std::min(1.0, parameters.bound / std::max(moved.norm(), parameters.bound));
      }
    }
  }
}
} // namespace bone
