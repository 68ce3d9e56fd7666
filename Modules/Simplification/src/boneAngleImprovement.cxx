/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAngleImprovement.h"

#include "boneMeshRepair.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace bone
{
namespace
{
/** How far surfaces may go, as shares of the boundary's mean edge length, one after the other. */
constexpr std::array<double, 5> Distances = { 0.025, 0.05, 0.09, 0.15, 0.25 };
constexpr int                   Passes = 3; ///< within each
/** Cells are flipped where an angle is below this, rad (25 degrees). */
constexpr double FlippedAngle = 0.44;
/** Share of the bound on volumes that is left alone. */
constexpr double VolumeSlack = 0.3;

/** One run: the tools, which know the complex as it is. */
class Improver
{
public:
  Improver(TetraComplex & complex, const SurfaceTarget & surfaces, const AngleGoal & goal, const Execution & execution)
    : m_Complex(complex)
    , m_Execution(execution)
    , m_Goal(goal)
    , m_Edge(MeanBoundaryEdge(complex))
    , m_Bound(complex, surfaces, m_Edge)
    , m_Mover(complex, &m_Bound, execution)
    , m_Optimizer(complex, m_Mover, surfaces)
    , m_Repair(complex, m_Mover, Distances.back() * m_Edge)
    , m_Limit([this](IdType t) { return std::cos(m_Goal.floors.Of(m_Complex.Region(t))); })
  {
    m_Repair.SetMinimumCells(goal.minimumCells);
  }

  void
  SetDistance(double share)
  {
    m_Bound.SetBound(share * m_Edge);
    m_Repair.Forget();
    m_Optimizer.MarkAll();
  }

  /** Whether anything was changed. */
  bool
  Pass()
  {
    const auto  mark = [this](const std::vector<IdType> & cells) { m_Optimizer.Mark(cells); };
    std::size_t changes = m_Repair.Run(m_Limit, mark);
    changes += m_Optimizer.Run(m_Limit, m_Limit);
    if (changes > 0)
    {
      FlipParameters flips;
      flips.targetAngle = FlippedAngle;
      flips.minimumCells = m_Goal.minimumCells;
      const auto note = [&mark](const FlipResult & flip) { mark(flip.created); };
      ImproveByFlips(m_Complex, flips, note, nullptr, m_Execution.Silent());
    }
    return changes > 0;
  }

  PointMover &
  Mover()
  {
    return m_Mover;
  }

private:
  TetraComplex &    m_Complex;
  const Execution & m_Execution;
  const AngleGoal & m_Goal;
  double            m_Edge; ///< mean of the boundary, mm
  SurfaceBound      m_Bound;
  PointMover        m_Mover;
  PointOptimizer    m_Optimizer;
  MeshRepair        m_Repair;
  CosineLimit       m_Limit;
};
} // namespace

std::size_t
AngleFloors::CountBelow(const TetraComplex & complex) const
{
  std::size_t count = 0;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    count += complex.IsAlive(t) && CellCosine(complex, t) > std::cos(this->Of(complex.Region(t))) ? 1 : 0;
  }
  return count;
}

AngleImprovement::AngleImprovement(const TetraComplex & finest)
  : m_Surfaces(finest, 0.0, 0)
  , m_Volumes(finest)
{}

bool
AngleImprovement::Run(TetraComplex & complex, const AngleGoal & goal, const Execution & execution) const
{
  const AngleFloors & floors = goal.floors;
  if (floors.CountBelow(complex) == 0)
  {
    return false;
  }
  bool                     changed = false;
  VolumeKeeper::Parameters keep;
  keep.cosineFloor = std::cos(std::max(floors.cortical, floors.other));
  keep.slack = VolumeSlack * goal.volumeChange;
  Improver improver(complex, m_Surfaces, goal, execution);
  for (const double distance : Distances)
  {
    improver.SetDistance(distance);
    for (int pass = 0; pass < Passes && floors.CountBelow(complex) > 0; ++pass)
    {
      const TetraComplex before = complex;
      if (!improver.Pass())
      {
        break;
      }
      m_Volumes.Restore(complex, improver.Mover(), keep);
      if (m_Volumes.LargestChange(complex) > std::max(goal.volumeChange, m_Volumes.LargestChange(before)))
      {
        complex = before;
        return changed;
      }
      changed = true;
    }
  }
  return changed;
}
} // namespace bone
