/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAngleImprovement.h"

#include "boneAngleRelaxation.h"
#include "boneTetraFlips.h"

#include <algorithm>
#include <array>

namespace bone
{
namespace
{
/** How far surfaces may go from what they were, of the boundary's mean edge length. */
constexpr double SurfaceShare = 0.25;
/** Cells are flipped where an angle is below this, rad (25 degrees). */
constexpr double FlippedAngle = 0.44;

/** Weights of the merit while it is raised: that of cells below their floor is doubled until none is left. */
struct Weights
{
  double surfaces;
  double floors;
  double largestFloors;
};
/** At first cells get their shape, then surfaces come back. */
constexpr std::array<Weights, 2> Steps = { { { 250.0, 8.0, 64.0 }, { 500.0, 16.0, 1024.0 } } };
constexpr int                    Sweeps = 2; ///< before a weight is doubled

/** One run: the tools, which know the complex as it is. */
class Improver
{
public:
  Improver(TetraComplex &        complex,
           const SurfaceTarget & surfaces,
           const RegionVolumes & volumes,
           const AngleGoal &     goal,
           const Execution &     execution)
    : m_Complex(complex)
    , m_Goal(goal)
    , m_Execution(execution.Silent())
    , m_Bound(complex, surfaces, SurfaceShare * MeanBoundaryEdge(complex))
    , m_Mover(complex, &m_Bound, execution)
    , m_Merit(surfaces, volumes, goal, complex)
    , m_Relaxation(complex, m_Mover, m_Merit, { goal.minimumCells, goal.maximumCells }, m_Execution)
  {}

  void
  Run(const Weights & weights)
  {
    m_Merit.SetWeights(weights.surfaces, weights.floors);
    m_Relaxation.Forget();
    for (int i = 0; i < Sweeps; ++i)
    {
      this->Sweep();
    }
    for (double floors = 2.0 * weights.floors; floors <= weights.largestFloors; floors *= 2.0)
    {
      const std::vector<IdType> below = m_Goal.floors.FindBelow(m_Complex);
      if (below.empty())
      {
        return;
      }
      m_Merit.SetWeights(weights.surfaces, floors);
      m_Relaxation.Forget(below);
      this->Sweep();
    }
  }

private:
  void
  Sweep()
  {
    m_Relaxation.Sweep();
    FlipParameters flips;
    flips.targetAngle = FlippedAngle;
    flips.minimumCells = m_Goal.minimumCells;
    flips.cellCount = m_Complex.AliveCells() < m_Goal.maximumCells ? FlipCellCount::Any : FlipCellCount::NotMore;
    ImproveByFlips(m_Complex, flips, {}, nullptr, m_Execution);
  }

  TetraComplex &    m_Complex;
  const AngleGoal & m_Goal;
  Execution         m_Execution;
  SurfaceBound      m_Bound;
  PointMover        m_Mover;
  AngleMerit        m_Merit;
  AngleRelaxation   m_Relaxation;
};
} // namespace

AngleImprovement::AngleImprovement(const TetraComplex & finest)
  : m_Surfaces(finest, 0.0, 0)
  , m_Volumes(finest)
{}

bool
AngleImprovement::Run(TetraComplex & complex, const AngleGoal & goal, const Execution & execution) const
{
  const TetraComplex before = complex;
  Improver           improver(complex, m_Surfaces, m_Volumes, goal, execution);
  for (const Weights & weights : Steps)
  {
    improver.Run(weights);
  }
  if (m_Volumes.LargestChangeTo(complex) > std::max(goal.volumeChange, m_Volumes.LargestChangeTo(before)))
  {
    complex = before;
  }
  return complex.Clock() != before.Clock();
}
} // namespace bone
