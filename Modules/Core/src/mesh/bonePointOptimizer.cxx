/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bonePointOptimizer.h"

#include <algorithm>
#include <cmath>

namespace bone
{
std::vector<std::pair<double, IdType>>
FindWorstCells(const TetraComplex & complex, double limit)
{
  std::vector<std::pair<double, IdType>> worst;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    if (!complex.IsAlive(t))
    {
      continue;
    }
    const double cosine = CellCosine(complex, t);
    if (cosine > limit)
    {
      worst.emplace_back(-cosine, t);
    }
  }
  std::sort(worst.begin(), worst.end());
  return worst;
}

const std::vector<Vector3> &
SearchDirections()
{
  static const std::vector<Vector3> directions = [] {
    std::vector<Vector3> found;
    for (int i = -1; i <= 1; ++i)
    {
      for (int j = -1; j <= 1; ++j)
      {
        for (int k = -1; k <= 1; ++k)
        {
          if (std::abs(i) + std::abs(j) + std::abs(k) == 1 || i * j * k != 0)
          {
            found.push_back(Vector3(i, j, k).normalized());
          }
        }
      }
    }
    return found;
  }();
  return directions;
}

PointOptimizer::PointOptimizer(TetraComplex & complex, PointMover & mover, const SurfaceTarget & target)
  : m_Complex(complex)
  , m_Mover(mover)
  , m_Target(target)
{
  MarkAll();
}

std::size_t
PointOptimizer::Run(double limit, double surfaceLimit)
{
  std::size_t       moves = 0;
  std::vector<char> seen(m_Complex.Points().size(), 0);
  m_Dirty.resize(seen.size(), 1);
  for (const auto & candidate : FindWorstCells(m_Complex, limit))
  {
    const int least = -candidate.first > surfaceLimit ? 1 : 3;
    for (IdType p : m_Complex.Cell(candidate.second))
    {
      if (m_Dirty[p] && !seen[p] && m_Complex.Dimension(p) >= least)
      {
        m_Dirty[p] = 0;
        seen[p] = 1;
        moves += Improve(p);
      }
    }
  }
  return moves;
}

void
PointOptimizer::MarkAll()
{
  m_Dirty.assign(m_Complex.Points().size(), 1);
}

void
PointOptimizer::Mark(const std::vector<IdType> & cells)
{
  m_Dirty.resize(m_Complex.Points().size(), 1);
  for (IdType t : cells)
  {
    for (IdType p : m_Complex.Cell(t))
    {
      m_Dirty[p] = 1;
    }
  }
}

bool
PointOptimizer::Improve(IdType p)
{
  constexpr int    stages = 4;
  constexpr double gain = 1e-4, first = 0.15, shrink = 0.4;
  const auto       neighbors = m_Complex.PointNeighbors(p);
  const Vector3    start = m_Complex.Points()[p];
  double           step = 0.0;
  for (IdType q : neighbors)
  {
    step += first * (m_Complex.Points()[q] - start).norm() / static_cast<double>(neighbors.size());
  }
  // Surface points slide: they keep what they have been moved off their target.
  const Vector3 offset = start - m_Target.Project(m_Complex, p, start);
  double        worst = m_Mover.WorstCosine(p);
  m_Better.clear();
  for (int stage = 0; stage < stages; ++stage, step *= shrink)
  {
    const Vector3 centre = m_Better.empty() ? start : m_Better.back();
    for (const Vector3 & direction : SearchDirections())
    {
      const Vector3 x = m_Target.Project(m_Complex, p, centre + step * direction) + offset;
      const double  cosine = WorstAt(p, x, worst);
      if (cosine < worst - gain)
      {
        worst = cosine;
        m_Better.push_back(x);
      }
    }
  }
  // The best place may be refused where one on the way to it is not.
  while (!m_Better.empty() && m_Mover.TryMove(p, m_Better.back(), 1.0) != MeshOperation::Done)
  {
    m_Better.pop_back();
  }
  if (m_Better.empty())
  {
    return false;
  }
  m_Dirty.resize(m_Complex.Points().size(), 1);
  for (IdType q : neighbors)
  {
    m_Dirty[q] = 1;
  }
  return true;
}

/** Worst cosine with p at x, or some value not below `limit`; 2 where a cell is not positive in floating point. The
 * mesh is unchanged. */
double
PointOptimizer::WorstAt(IdType p, const Vector3 & x, double limit)
{
  const auto &  points = m_Complex.Points();
  const Vector3 before = points[p];
  double        worst = -1.0;
  m_Complex.TryPoint(p, x);
  for (auto t = m_Complex.Star(p).begin(); t != m_Complex.Star(p).end() && worst < limit; ++t)
  {
    const Id4 & c = m_Complex.Cell(*t);
    const bool  positive = SignedVolume(points[c[0]], points[c[1]], points[c[2]], points[c[3]]) > 0;
    worst = positive ? std::max(worst, CellCosine(m_Complex, *t)) : 2.0;
  }
  m_Complex.TryPoint(p, before);
  return worst;
}
} // namespace bone
