/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneWallMerge.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace tiling
{
namespace
{
/** Cheapest monotone merge of two sequences of positions, by the length of the spans. */
std::vector<std::uint8_t>
MergeSequences(const std::vector<Vector2> & x, const std::vector<Vector2> & y, double & total)
{
  const std::size_t         stride = y.size();
  std::vector<double>       cost(x.size() * stride, Infinity);
  std::vector<std::uint8_t> from(cost.size(), 2);
  cost[0] = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
  {
    for (std::size_t j = 0; j < y.size(); ++j)
    {
      if (i + j == 0)
      {
        continue;
      }
      const double before0 = i > 0 ? cost[(i - 1) * stride + j] : Infinity;
      const double before1 = j > 0 ? cost[i * stride + j - 1] : Infinity;
      from[i * stride + j] = before0 <= before1 ? 0 : 1;
      cost[i * stride + j] = std::min(before0, before1) + (x[i] - y[j]).norm();
    }
  }
  total = cost.back();
  std::vector<std::uint8_t> letters;
  for (std::size_t i = x.size() - 1, j = y.size() - 1; i > 0 || j > 0;)
  {
    const std::uint8_t letter = from[i * stride + j];
    letters.push_back(letter);
    (letter == 0 ? i : j) -= 1;
  }
  std::reverse(letters.begin(), letters.end());
  return letters;
}

/** A closed tour (part of a walk round a tree): steps begin..begin + count of the walk, from a root back to it. */
struct Tour
{
  const Walk * walk;
  int          begin;
  int          count;

  int
  Vertex(int step) const
  {
    return (*walk)[(begin + step) % walk->size()];
  }
};

/** The path from a tour's root to its deepest vertex, and the tours of the branches beside it. */
struct MainPath
{
  std::vector<int>  vertices;
  std::vector<Tour> right; ///< at each path vertex, branches met on the way out
  std::vector<Tour> left;  ///< at each path vertex, branches met on the way back
};

MainPath
FindMainPath(const std::vector<Vector2> & plane, const Tour & tour)
{
  // Depth along the tour; a step onto the vertex below the top of the stack goes back.
  std::vector<int>    stack{ 0 };
  std::vector<double> depth{ 0.0 };
  std::vector<int>    deepest = stack;
  double              best = 0.0;
  for (int s = 1; s <= tour.count; ++s)
  {
    if (stack.size() > 1 && tour.Vertex(stack[stack.size() - 2]) == tour.Vertex(s))
    {
      stack.pop_back();
      depth.pop_back();
      continue;
    }
    depth.push_back(depth.back() + (plane[tour.Vertex(s)] - plane[tour.Vertex(stack.back())]).norm());
    stack.push_back(s);
    if (depth.back() > best)
    {
      best = depth.back();
      deepest = stack;
    }
  }
  MainPath  path;
  const int n = static_cast<int>(deepest.size());
  // deepest[i] is the step at which path vertex i is first met. On the way out the branches at it lie before the last
  // visit that precedes the first visit of vertex i + 1; on the way back likewise, mirrored.
  std::vector<int> back(n);
  back[n - 1] = deepest[n - 1];
  int step = deepest[n - 1];
  for (int i = n - 2; i >= 0; --i)
  {
    // The next step onto vertex i with everything beyond closed: the tour of a tree returns over the same edge.
    int              open = 1;
    int              previous = tour.Vertex(step);
    std::vector<int> trail{ tour.Vertex(deepest[i]), previous };
    while (open > 0)
    {
      ++step;
      const int v = tour.Vertex(step);
      if (trail.size() > 1 && trail[trail.size() - 2] == v)
      {
        trail.pop_back();
        open = trail.size() > 1 ? 1 : 0;
      }
      else
      {
        trail.push_back(v);
      }
    }
    back[i] = step;
  }
  for (int i = 0; i < n; ++i)
  {
    path.vertices.push_back(tour.Vertex(deepest[i]));
    const int outEnd = i + 1 < n ? deepest[i + 1] - 1 : deepest[i];
    const int backEnd = i == 0 ? tour.count : back[i - 1] - 1;
    path.right.push_back({ tour.walk, tour.begin + deepest[i], outEnd - deepest[i] });
    path.left.push_back({ tour.walk, tour.begin + back[i], i + 1 < n ? backEnd - back[i] : 0 });
  }
  return path;
}

void
Emit(std::vector<std::uint8_t> & letters, std::uint8_t letter, int count)
{
  letters.insert(letters.end(), static_cast<std::size_t>(count), letter);
}

void
MergeTours(const std::vector<Vector2> & plane, const Tour & x, const Tour & y, std::vector<std::uint8_t> & letters);

/** The branches of both trees that hang at one node of the merged main path. */
void
MergeBranches(const std::vector<Vector2> & plane,
              const Tour &                 x,
              const Tour &                 y,
              bool                         useX,
              bool                         useY,
              std::vector<std::uint8_t> &  letters)
{
  if (useX && useY && x.count > 0 && y.count > 0)
  {
    MergeTours(plane, x, y, letters);
    return;
  }
  Emit(letters, 0, useX ? x.count : 0);
  Emit(letters, 1, useY ? y.count : 0);
}

void
MergeTours(const std::vector<Vector2> & plane, const Tour & x, const Tour & y, std::vector<std::uint8_t> & letters)
{
  if (x.count == 0 || y.count == 0)
  {
    Emit(letters, 0, x.count);
    Emit(letters, 1, y.count);
    return;
  }
  const MainPath       px = FindMainPath(plane, x), py = FindMainPath(plane, y);
  std::vector<Vector2> qx, qy;
  for (int v : px.vertices)
  {
    qx.push_back(plane[v]);
  }
  for (int v : py.vertices)
  {
    qy.push_back(plane[v]);
  }
  double                                           total = 0.0;
  const std::vector<std::uint8_t>                  moves = MergeSequences(qx, qy, total);
  std::vector<std::pair<std::size_t, std::size_t>> nodes{ { 0, 0 } };
  for (std::uint8_t letter : moves)
  {
    auto next = nodes.back();
    (letter == 0 ? next.first : next.second) += 1;
    nodes.push_back(next);
  }
  // Each path vertex hangs its branches at the node where it is nearest to its counterpart.
  std::vector<std::size_t> hostX(qx.size(), nodes.size()), hostY(qy.size(), nodes.size());
  for (std::size_t m = 0; m < nodes.size(); ++m)
  {
    const auto [i, j] = nodes[m];
    const double d = (qx[i] - qy[j]).norm();
    if (hostX[i] == nodes.size() || d < (qx[i] - qy[nodes[hostX[i]].second]).norm())
    {
      hostX[i] = m;
    }
    if (hostY[j] == nodes.size() || d < (qx[nodes[hostY[j]].first] - qy[j]).norm())
    {
      hostY[j] = m;
    }
  }
  for (std::size_t m = 0; m < nodes.size(); ++m)
  {
    const auto [i, j] = nodes[m];
    MergeBranches(plane, px.right[i], py.right[j], hostX[i] == m, hostY[j] == m, letters);
    if (m < moves.size())
    {
      letters.push_back(moves[m]);
    }
  }
  for (std::size_t m = nodes.size(); m-- > 0;)
  {
    const auto [i, j] = nodes[m];
    MergeBranches(plane, px.left[i], py.left[j], hostX[i] == m, hostY[j] == m, letters);
    if (m > 0)
    {
      letters.push_back(moves[m - 1]);
    }
  }
}

/** Positions at which a walk round a tree turns about a leaf. */
std::vector<int>
Leaves(const Walk & walk)
{
  const int        n = static_cast<int>(walk.size());
  std::vector<int> leaves;
  for (int i = 0; i < n; ++i)
  {
    if (n < 3 || walk[(i + n - 1) % n] == walk[(i + 1) % n])
    {
      leaves.push_back(i);
    }
  }
  return leaves;
}

/** Roots of the two tours: leaves whose main paths agree best in both ends. */
std::vector<std::array<int, 2>>
RankRoots(const std::vector<Vector2> & plane, const Walk & x, const Walk & y)
{
  struct Candidate
  {
    double             cost;
    std::array<int, 2> roots;
  };
  const auto endsOf = [&plane](const Walk & walk) {
    std::vector<std::array<int, 2>> ends; // root position, far vertex
    for (int leaf : Leaves(walk))
    {
      const MainPath path = FindMainPath(plane, Tour{ &walk, leaf, WalkSteps(walk) });
      ends.push_back({ { leaf, path.vertices.back() } });
    }
    return ends;
  };
  std::vector<Candidate> candidates;
  const auto             ex = endsOf(x), ey = endsOf(y);
  for (const auto & a : ex)
  {
    for (const auto & b : ey)
    {
      // Long main paths are preferred: a short one would draw the longer arms together.
      const double length = (plane[x[a[0]]] - plane[a[1]]).norm() + (plane[y[b[0]]] - plane[b[1]]).norm();
      const double cost = (plane[x[a[0]]] - plane[y[b[0]]]).norm() + (plane[a[1]] - plane[b[1]]).norm() - 0.5 * length;
      candidates.push_back({ cost, { { a[0], b[0] } } });
    }
  }
  std::stable_sort(
    candidates.begin(), candidates.end(), [](const Candidate & a, const Candidate & b) { return a.cost < b.cost; });
  std::vector<std::array<int, 2>> roots;
  for (const Candidate & candidate : candidates)
  {
    roots.push_back(candidate.roots);
  }
  return roots;
}

} // namespace

bool
MergeClosedWalks(const std::vector<Vector2> & plane, const Walk & x, const Walk & y, int variant, Merge & wall)
{
  const int n = static_cast<int>(x.size());
  const int starts = std::min(n, 4);
  if (variant >= starts)
  {
    return false;
  }
  wall.first = static_cast<int>(static_cast<long>(variant) * n / starts);
  wall.second = 0;
  for (int j = 1; j < static_cast<int>(y.size()); ++j)
  {
    if ((plane[y[j]] - plane[x[wall.first]]).squaredNorm() <
        (plane[y[wall.second]] - plane[x[wall.first]]).squaredNorm())
    {
      wall.second = j;
    }
  }
  std::vector<Vector2> qx, qy;
  for (int i = 0; i <= WalkSteps(x); ++i)
  {
    qx.push_back(plane[x[(wall.first + i) % n]]);
  }
  for (int j = 0; j <= WalkSteps(y); ++j)
  {
    qy.push_back(plane[y[(wall.second + j) % y.size()]]);
  }
  double total = 0.0;
  wall.letters = MergeSequences(qx, qy, total);
  return true;
}

std::vector<int>
LongestPath(const std::vector<Vector2> & plane, const Walk & treeWalk)
{
  if (treeWalk.size() < 2)
  {
    return treeWalk;
  }
  // The deepest vertex from any root is an end of the longest path.
  const int  n = WalkSteps(treeWalk);
  const int  end = FindMainPath(plane, Tour{ &treeWalk, 0, n }).vertices.back();
  const auto at = std::find(treeWalk.begin(), treeWalk.end(), end) - treeWalk.begin();
  return FindMainPath(plane, Tour{ &treeWalk, static_cast<int>(at), n }).vertices;
}

bool
MergeInnermostWalks(const std::vector<Vector2> & plane,
                    const Section &              lower,
                    const Section &              upper,
                    int                          variant,
                    Merge &                      wall)
{
  const Walk & x = lower.walks.back();
  const Walk & y = upper.walks.back();
  wall.letters.clear();
  if (lower.hole || upper.hole)
  {
    return MergeClosedWalks(plane, x, y, variant, wall);
  }
  if (WalkSteps(x) == 0 || WalkSteps(y) == 0)
  {
    if (variant > 0)
    {
      return false;
    }
    wall.first = wall.second = 0;
    Emit(wall.letters, 0, WalkSteps(x));
    Emit(wall.letters, 1, WalkSteps(y));
    return true;
  }
  const auto roots = RankRoots(plane, x, y);
  if (variant >= static_cast<int>(std::min<std::size_t>(roots.size(), 4)))
  {
    return false;
  }
  wall.first = roots[variant][0];
  wall.second = roots[variant][1];
  MergeTours(plane, Tour{ &x, wall.first, WalkSteps(x) }, Tour{ &y, wall.second, WalkSteps(y) }, wall.letters);
  return true;
}
} // namespace tiling
} // namespace bone
