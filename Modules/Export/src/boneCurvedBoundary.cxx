/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCurvedBoundary.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

namespace bone
{
namespace
{
/** Nodes on edges of the boundary, but for those of flat cuts. */
std::set<IdType>
BoundaryEdgeNodes(const FiniteElementModel & model)
{
  std::set<IdType> nodes;
  for (const FiniteElementFace & face : model.exterior)
  {
    const auto ids = FiniteElementFaceNodes(model, face);
    nodes.insert(ids.begin() + 3, ids.end());
  }
  for (const FiniteElementSet & set : model.nodeSets)
  {
    for (std::size_t i = 0; set.name.rfind("CUT_", 0) == 0 && i < set.ids.size(); ++i)
    {
      nodes.erase(set.ids[i]);
    }
  }
  return nodes;
}

/** The node of an element that was moved, and moved farthest; -1 where none was. */
IdType
FarthestMoved(const FiniteElementModel & model, std::size_t element, const std::map<IdType, Vector3> & middles)
{
  IdType farthest = -1;
  double move = 0.0;
  for (std::size_t i = 4; i < 10; ++i)
  {
    const auto found = middles.find(model.elements[element][i]);
    if (found != middles.end())
    {
      const double distance = (model.nodes[static_cast<std::size_t>(found->first)] - found->second).norm();
      if (distance > move)
      {
        move = distance;
        farthest = found->first;
      }
    }
  }
  return farthest;
}
} // namespace

double
LeastRelativeJacobian(const FiniteElementModel & model, std::size_t element)
{
  const auto & nodes = model.elements[element];
  const auto   x = [&](int i) { return model.nodes[static_cast<std::size_t>(nodes[static_cast<std::size_t>(i)])]; };
  // Control point of the quadratic map for a pair of corners.
  const auto control = [&](int a, int b) -> Vector3 {
    return a == b ? x(a) : Vector3(2.0 * x(FiniteElementEdgeNode(a, b)) - 0.5 * (x(a) + x(b)));
  };
  // Half the derivative along edge 0k at its control point of corner v.
  std::array<std::array<Vector3, 4>, 3> slope;
  for (int k = 0; k < 3; ++k)
  {
    for (int v = 0; v < 4; ++v)
    {
      slope[static_cast<std::size_t>(k)][static_cast<std::size_t>(v)] = control(v, k + 1) - control(v, 0);
    }
  }
  const auto det = [&](std::size_t p, std::size_t q, std::size_t r) {
    return slope[0][p].dot(slope[1][q].cross(slope[2][r]));
  };
  double least = std::numeric_limits<double>::max();
  for (std::size_t p = 0; p < 4; ++p)
  {
    for (std::size_t q = p; q < 4; ++q)
    {
      for (std::size_t r = q; r < 4; ++r)
      {
        const double sum = det(p, q, r) + det(q, r, p) + det(r, p, q) + det(p, r, q) + det(r, q, p) + det(q, p, r);
        least = std::min(least, sum / 6.0);
      }
    }
  }
  const double straight = (x(1) - x(0)).dot((x(2) - x(0)).cross(x(3) - x(0)));
  return 8.0 * least / straight; // slopes are half the edges where these are straight
}

CurvedBoundary
CurveBoundary(const TriangleDistance & surface, FiniteElementModel & model)
{
  if (model.order != 2)
  {
    throw std::invalid_argument("Elements of four nodes have straight edges: a boundary on a surface needs ten.");
  }
  std::map<IdType, Vector3> middles; // of the nodes that are moved
  for (const IdType node : BoundaryEdgeNodes(model))
  {
    Vector3 & x = model.nodes[static_cast<std::size_t>(node)];
    middles[node] = x;
    x = surface.FindNearest(x).point;
  }
  CurvedBoundary result;
  for (bool changed = true; changed;)
  {
    changed = false;
    for (std::size_t e = 0; e < model.elements.size(); ++e)
    {
      for (IdType node = FarthestMoved(model, e, middles);
           node >= 0 && LeastRelativeJacobian(model, e) < LeastCurvedJacobian;
           node = FarthestMoved(model, e, middles))
      {
        model.nodes[static_cast<std::size_t>(node)] = middles[node];
        middles.erase(node);
        ++result.refused;
        changed = true;
      }
    }
  }
  result.curved = static_cast<IdType>(middles.size());
  for (const auto & [node, middle] : middles)
  {
    result.largestMove = std::max(result.largestMove, (model.nodes[static_cast<std::size_t>(node)] - middle).norm());
  }
  return result;
}
} // namespace bone
