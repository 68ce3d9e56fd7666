/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSmoothingKernel.h"

#include "boneTetraFlips.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
/** Steps back of a move before it is given up. */
constexpr int MaximumSteps = 6;

Vector3
MeanOf(const std::vector<Vector3> & points, const std::vector<IdType> & ids)
{
  Vector3 sum = Vector3::Zero();
  for (IdType p : ids)
  {
    sum += points[p];
  }
  return sum / static_cast<double>(ids.size());
}

/** Neighbours in the point's own stratum and those it bounds it with: all, along surfaces, or along the curve. */
std::vector<IdType>
StratumNeighbors(const TetraComplex & complex, IdType p)
{
  switch (complex.Dimension(p))
  {
    case 3:
      return complex.PointNeighbors(p);
    case 2:
    {
      std::vector<TetraComplex::SurfaceFace> faces;
      complex.SurfaceStar(p, faces);
      std::vector<IdType> neighbors;
      for (const auto & face : faces)
      {
        neighbors.push_back(face.a);
      }
      return neighbors;
    }
    default:
      return complex.Surfaces().curve[p];
  }
}

void
PlainIteration(TetraComplex & complex, PointMover & mover, bool smart, SmoothingReport & report)
{
  for (IdType p = 0; p < static_cast<IdType>(complex.Points().size()); ++p)
  {
    if (complex.Star(p).empty())
    {
      continue;
    }
    const Vector3       mean = MeanOf(complex.Points(), complex.PointNeighbors(p));
    const MeshOperation outcome = smart ? mover.TryMove(p, mean, 1.0) : MeshOperation::Done;
    if (outcome != MeshOperation::Done)
    {
      ++report.refused[static_cast<int>(outcome)];
      continue;
    }
    complex.MovePoint(p, mean);
    ++report.moves;
  }
}

/** Pattern search: steps along axes and diagonals, shrinking from stage to stage. */
class PointOptimizer
{
public:
  PointOptimizer(TetraComplex & complex, PointMover & mover, const SurfaceTarget & target)
    : m_Complex(complex)
    , m_Mover(mover)
    , m_Target(target)
    , m_Dirty(complex.Points().size(), 1)
  {
    for (int i = -1; i <= 1; ++i)
    {
      for (int j = -1; j <= 1; ++j)
      {
        for (int k = -1; k <= 1; ++k)
        {
          if (std::abs(i) + std::abs(j) + std::abs(k) == 1 || i * j * k != 0)
          {
            m_Directions.push_back(Vector3(i, j, k).normalized());
          }
        }
      }
    }
  }

  /** Moves the points of all cells whose smallest dihedral angle has a cosine above the limit, the worst first, each
   * once. Returns the number of moves. */
  std::size_t
  Run(double limit)
  {
    std::vector<std::pair<double, IdType>> worst;
    for (IdType t = 0; t < m_Complex.Size(); ++t)
    {
      const double cosine = m_Complex.IsAlive(t) ? CellCosine(m_Complex, t) : -1.0;
      if (cosine > limit)
      {
        worst.emplace_back(-cosine, t);
      }
    }
    std::sort(worst.begin(), worst.end());
    std::size_t       moves = 0;
    std::vector<char> seen(m_Dirty.size(), 0);
    for (const auto & candidate : worst)
    {
      for (IdType p : m_Complex.Cell(candidate.second))
      {
        if (m_Dirty[p] && !seen[p] && m_Complex.Dimension(p) > 0)
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
  MarkAll()
  {
    std::fill(m_Dirty.begin(), m_Dirty.end(), 1);
  }
  void
  Mark(const FlipResult & flip)
  {
    for (IdType t : flip.created)
    {
      for (IdType p : m_Complex.Cell(t))
      {
        m_Dirty[p] = 1;
      }
    }
  }

private:
  bool
  Improve(IdType p)
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
    const double before = m_Mover.WorstCosine(p);
    double       worst = before;
    Vector3      best = start;
    for (int stage = 0; stage < stages; ++stage, step *= shrink)
    {
      const Vector3 centre = best;
      for (const Vector3 & direction : m_Directions)
      {
        const Vector3 x = m_Target.Project(m_Complex, p, centre + step * direction);
        const double  cosine = WorstAt(p, x, worst);
        if (cosine < worst)
        {
          worst = cosine;
          best = x;
        }
      }
    }
    if (!(worst < before - gain) || m_Mover.TryMove(p, best, -1.0) != MeshOperation::Done)
    {
      return false;
    }
    for (IdType q : neighbors)
    {
      m_Dirty[q] = 1;
    }
    return true;
  }

  /** Worst cosine with p at x, or some value not below `limit`; 2 where a cell is not positive in floating point. The
   * mesh is unchanged. */
  double
  WorstAt(IdType p, const Vector3 & x, double limit)
  {
    const auto &  points = m_Complex.Points();
    const Vector3 before = points[p];
    double        worst = -1.0;
    m_Complex.MovePoint(p, x);
    for (auto t = m_Complex.Star(p).begin(); t != m_Complex.Star(p).end() && worst < limit; ++t)
    {
      const Id4 & c = m_Complex.Cell(*t);
      const bool  positive = SignedVolume(points[c[0]], points[c[1]], points[c[2]], points[c[3]]) > 0;
      worst = positive ? std::max(worst, CellCosine(m_Complex, *t)) : 2.0;
    }
    m_Complex.MovePoint(p, before);
    return worst;
  }

  TetraComplex &        m_Complex;
  PointMover &          m_Mover;
  const SurfaceTarget & m_Target;
  std::vector<Vector3>  m_Directions;
  std::vector<char>     m_Dirty; ///< something at the point has changed since it was last looked at
};
} // namespace

void
EnhancedIteration(TetraComplex &              complex,
                  PointMover &                mover,
                  const SurfaceTarget &       target,
                  const SmoothingParameters & parameters,
                  SmoothingReport &           report)
{
  const double cosineFloor = std::cos(parameters.angleFloor);
  for (IdType p = 0; p < static_cast<IdType>(complex.Points().size()); ++p)
  {
    if (complex.Star(p).empty() || complex.Dimension(p) == 0)
    {
      continue;
    }
    const Vector3 old = complex.Points()[p];
    Vector3       x = target.Place(complex, p, MeanOf(complex.Points(), StratumNeighbors(complex, p)));
    MeshOperation outcome = mover.TryMove(p, x, cosineFloor);
    int           step = 0;
    for (; outcome != MeshOperation::Done && step < MaximumSteps; ++step)
    {
      x = target.Project(complex, p, parameters.weight * old + (1.0 - parameters.weight) * x);
      outcome = mover.TryMove(p, x, cosineFloor);
    }
    if (outcome == MeshOperation::Done)
    {
      ++report.moves;
      report.weighted += step > 0;
    }
    else
    {
      ++report.refused[static_cast<int>(outcome)];
    }
  }
}

SmoothingReport
SmoothPoints(TetraComplex & complex, const SmoothingParameters & parameters, const ProgressFunction & progress)
{
  SmoothingReport report;
  PointMover      mover(complex);
  const bool      enhanced = parameters.method == SmoothingMethod::Enhanced;
  SurfaceTarget   target(complex, parameters.distanceBound, enhanced ? parameters.fairingIterations : 0);
  for (int i = 0; i < parameters.iterations; ++i)
  {
    if (enhanced)
    {
      EnhancedIteration(complex, mover, target, parameters, report);
    }
    else
    {
      PlainIteration(complex, mover, parameters.method == SmoothingMethod::Smart, report);
    }
    if (progress)
    {
      progress(double(i + 1) / parameters.iterations);
    }
  }
  return report;
}

ImprovementReport
ImproveMesh(TetraComplex & complex, const ImprovementParameters & parameters, const ProgressFunction & progress)
{
  ImprovementReport           report;
  const SmoothingParameters & smoothing = parameters.smoothing;
  PointMover                  mover(complex);
  const SurfaceTarget         target(complex, smoothing.distanceBound, smoothing.fairingIterations);
  FlipParameters              flips;
  flips.targetAngle = parameters.targetAngle;
  PointOptimizer optimizer(complex, mover, target);
  const auto     observer = [&](const FlipResult & flip) { optimizer.Mark(flip); };
  const double   limit = std::cos(parameters.targetAngle);
  const auto     advance = [&](double done) {
    if (progress)
    {
      progress(done);
    }
  };
  for (int round = 0; round < parameters.rounds; ++round)
  {
    const int iterations = round == 0 ? smoothing.iterations : std::min(2, smoothing.iterations);
    for (int i = 0; i < iterations; ++i)
    {
      EnhancedIteration(complex, mover, target, smoothing, report.smoothing);
      advance((round + 0.4 * (i + 1) / iterations) / parameters.rounds);
    }
    optimizer.MarkAll();
    report.flips += ImproveByFlips(complex, flips).done;
    advance((round + 0.6) / parameters.rounds);
    for (int pass = 0; pass < parameters.optimizationPasses; ++pass)
    {
      report.optimized += optimizer.Run(limit);
      report.flips += ImproveByFlips(complex, flips, observer).done;
      advance((round + 0.6 + 0.4 * (pass + 1) / parameters.optimizationPasses) / parameters.rounds);
    }
  }
  return report;
}
} // namespace bone
