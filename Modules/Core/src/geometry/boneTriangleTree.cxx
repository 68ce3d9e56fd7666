/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneTriangleTree.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace bone
{
namespace
{
constexpr int LeafSize = 4;

double
SquaredDistanceToBox(const Vector3 & x, const Vector3 & lower, const Vector3 & upper)
{
  return (lower - x).cwiseMax(x - upper).cwiseMax(0.0).squaredNorm();
}
} // namespace

Vector3
ClosestPointOnSegment(const Vector3 & x, const Vector3 & a, const Vector3 & b)
{
  const Vector3 ab = b - a;
  const double  length = ab.squaredNorm();
  if (!(length > 0))
  {
    return a;
  }
  return a + std::clamp((x - a).dot(ab) / length, 0.0, 1.0) * ab;
}

Vector3
ClosestPointOnTriangle(const Vector3 & x, const Vector3 & a, const Vector3 & b, const Vector3 & c)
{
  const Vector3 ab = b - a, ac = c - a, ax = x - a;
  const double  d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0)
  {
    return a;
  }
  const Vector3 bx = x - b;
  const double  d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3)
  {
    return b;
  }
  const Vector3 cx = x - c;
  const double  d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6)
  {
    return c;
  }
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  const double sum = va + vb + vc;
  if (va > 0 && vb > 0 && vc > 0)
  {
    return a + ab * (vb / sum) + ac * (vc / sum);
  }
  // On one of the edges that x lies beyond; of a degenerate triangle on any.
  Vector3 nearest = a;
  double  least = std::numeric_limits<double>::max();
  for (const auto & [side, from, to] : { std::tie(vc, a, b), std::tie(vb, a, c), std::tie(va, b, c) })
  {
    const Vector3 point = side > 0 ? nearest : ClosestPointOnSegment(x, from, to);
    const double  squared = side > 0 ? least : (point - x).squaredNorm();
    if (squared < least)
    {
      least = squared;
      nearest = point;
    }
  }
  return nearest;
}

TriangleTree::TriangleTree(std::vector<Triangle> triangles)
  : m_Triangles(std::move(triangles))
  , m_Order(m_Triangles.size())
{
  std::iota(m_Order.begin(), m_Order.end(), 0);
  if (!m_Triangles.empty())
  {
    m_Nodes.reserve(2 * m_Triangles.size() / LeafSize + 2);
    Build(0, static_cast<int>(m_Triangles.size()));
  }
  // Triangles of a leaf lie together in memory.
  const std::vector<Triangle> given = std::move(m_Triangles);
  m_Triangles.clear();
  m_Triangles.reserve(given.size());
  m_Place.resize(given.size());
  for (const int i : m_Order)
  {
    m_Place[i] = static_cast<int>(m_Triangles.size());
    m_Triangles.push_back(given[i]);
  }
}

int
TriangleTree::Build(int begin, int end)
{
  Eigen::AlignedBox3d box, centres;
  for (int i = begin; i < end; ++i)
  {
    const Triangle & t = m_Triangles[m_Order[i]];
    box.extend(t[0]).extend(t[1]).extend(t[2]);
    centres.extend(t[0] + t[1] + t[2]);
  }
  const int index = static_cast<int>(m_Nodes.size());
  m_Nodes.push_back(Node{ box.min(), box.max(), begin, end, -1 });
  if (end - begin > LeafSize)
  {
    int axis = 0;
    centres.sizes().maxCoeff(&axis);
    const int  middle = (begin + end) / 2;
    const auto centre = [&](int i) {
      return m_Triangles[i][0][axis] + m_Triangles[i][1][axis] + m_Triangles[i][2][axis];
    };
    std::nth_element(m_Order.begin() + begin, m_Order.begin() + middle, m_Order.begin() + end, [&](int i, int j) {
      return centre(i) != centre(j) ? centre(i) < centre(j) : i < j;
    });
    Build(begin, middle);
    const int right = Build(middle, end);
    m_Nodes[index].right = right;
  }
  return index;
}

TriangleTree::Nearest
TriangleTree::FindNearest(const Vector3 & x) const
{
  Nearest nearest;
  if (m_Nodes.empty())
  {
    return nearest;
  }
  nearest.squaredDistance = std::numeric_limits<double>::max();
  this->FindNearer(x, nearest);
  return nearest;
}

double
TriangleTree::FindSquaredDistance(const Vector3 & x, int & triangle) const
{
  if (m_Nodes.empty())
  {
    return std::numeric_limits<double>::max();
  }
  Nearest nearest;
  nearest.squaredDistance = std::numeric_limits<double>::max();
  if (triangle >= 0)
  {
    // A bound alone: of equally near triangles it is the one that FindNearest finds.
    const Triangle & t = this->GetTriangle(triangle);
    const double     squared = (ClosestPointOnTriangle(x, t[0], t[1], t[2]) - x).squaredNorm();
    nearest.squaredDistance = std::nextafter(squared, nearest.squaredDistance);
  }
  this->FindNearer(x, nearest);
  triangle = nearest.triangle;
  return nearest.squaredDistance;
}

void
TriangleTree::FindNearer(const Vector3 & x, Nearest & nearest) const
{
  // The tree is balanced: its depth is below 32, and each level leaves one node waiting.
  std::array<std::pair<double, int>, 64> stack;
  int                                    waiting = 0;
  stack[waiting++] = { 0.0, 0 };
  while (waiting > 0)
  {
    const auto [distance, index] = stack[--waiting];
    if (distance >= nearest.squaredDistance)
    {
      continue;
    }
    const Node & node = m_Nodes[index];
    if (node.right < 0)
    {
      for (int i = node.begin; i < node.end; ++i)
      {
        const Triangle & t = m_Triangles[i];
        const Vector3    point = ClosestPointOnTriangle(x, t[0], t[1], t[2]);
        const double     squared = (point - x).squaredNorm();
        if (squared < nearest.squaredDistance)
        {
          nearest = { point, squared, m_Order[i] };
        }
      }
      continue;
    }
    const int    left = index + 1, right = node.right;
    const double toLeft = SquaredDistanceToBox(x, m_Nodes[left].lower, m_Nodes[left].upper);
    const double toRight = SquaredDistanceToBox(x, m_Nodes[right].lower, m_Nodes[right].upper);
    const auto   near = std::make_pair(toLeft, left), far = std::make_pair(toRight, right);
    stack[waiting++] = toLeft <= toRight ? far : near;
    stack[waiting++] = toLeft <= toRight ? near : far;
  }
}

bool
TriangleTree::IsWithin(const Vector3 & x, double squaredDistance) const
{
  std::array<int, 64> stack;
  int                 waiting = 0;
  if (!m_Nodes.empty())
  {
    stack[waiting++] = 0;
  }
  while (waiting > 0)
  {
    const int    index = stack[--waiting];
    const Node & node = m_Nodes[index];
    if (SquaredDistanceToBox(x, node.lower, node.upper) > squaredDistance)
    {
      continue;
    }
    for (int i = node.begin; node.right < 0 && i < node.end; ++i)
    {
      const Triangle & t = m_Triangles[i];
      if ((ClosestPointOnTriangle(x, t[0], t[1], t[2]) - x).squaredNorm() <= squaredDistance)
      {
        return true;
      }
    }
    if (node.right >= 0)
    {
      stack[waiting++] = node.right;
      stack[waiting++] = index + 1;
    }
  }
  return false;
}
} // namespace bone
