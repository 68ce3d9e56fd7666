/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshImprovement.h"

#include "boneContourFlips.h"
#include "boneInteriorRefinement.h"
#include "boneSharpEdges.h"
#include "boneSideKeeper.h"
#include "boneSurfaceFit.h"
#include "boneVolumeKeeper.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
/** Edges longer than this many sizes are halved, those shorter than the other collapsed. */
constexpr double LongEdge = 1.5;
constexpr double ShortEdge = 0.6;
/** Of the distance bound: shorter edges are accidents of the input. */
constexpr double TinyEdge = 1e-3;
constexpr int    SmoothingsInRound = 2;
constexpr int    SliverPasses = 2;
/** Fits of surfaces between two of flips inside. */
constexpr int FitsToFlip = 2;
/** From one additional fit to the next. */
constexpr double StiffnessFactor = 1.3;
/** Smallest angle, rad, that points may leave where they are put on the right side of voxels. */
constexpr double SideAngle = 0.13;
/** Distance bounds that surfaces may go to mend cells below surfaceAngle. */
constexpr double SurfaceFactor = 1.5;

class MeshImprover
{
public:
  MeshImprover(TetraComplex & complex, const ImprovementParameters & parameters, const ProgressFunction & progress)
    : m_Complex(complex)
    , m_Parameters(parameters)
    , m_Progress(progress)
    , m_FirstTurn(MeanBoundaryTurn(complex, parameters.slices))
    , m_First(complex, 0.0, 0)
    , m_Bound(complex, m_First, parameters.distanceBound)
    , m_Mover(complex, &m_Bound)
    , m_Target(complex, parameters.distanceBound, parameters.fairingIterations)
    , m_Volumes(complex)
    , m_Optimizer(complex, m_Mover, m_Target)
    , m_Repair(complex, m_Mover, parameters.distanceBound)
  {}

  ImprovementReport
  Run()
  {
    const double steps = m_Parameters.rounds + 1.0;
    m_Report.repairs += m_Repair.CollapseShort(TinyEdge * m_Parameters.distanceBound);
    Smooth(m_Parameters.iterations, SurfaceMotion::ToFairedPlace);
    Advance(1.0 / steps);
    for (int round = 0; round < m_Parameters.rounds; ++round)
    {
      Smooth(SmoothingsInRound, SurfaceMotion::None);
      if (round + 1 < m_Parameters.rounds && m_Parameters.gradation > 0)
      {
        Refine();
      }
      RestoreVolumes(m_Parameters.surfaceAngle, 0.0);
      ImproveWorst((round + 1) / steps, 1.0 / steps);
      MendSlivers();
    }
    FitSurfacesAndInside();
    return m_Report;
  }

private:
  void
  Advance(double done) const
  {
    if (m_Progress)
    {
      m_Progress(done);
    }
  }

  /** mm, of surfaces from what they were. */
  void
  SetBound(double bound)
  {
    m_Bound.SetBound(bound);
    m_Repair.Forget();
  }

  void
  Smooth(int iterations, SurfaceMotion motion)
  {
    SmoothingParameters smoothing;
    smoothing.surfaceMotion = motion;
    for (int i = 0; i < iterations; ++i)
    {
      EnhancedIteration(m_Complex, m_Mover, m_Target, smoothing, m_Report.smoothing);
      Advance(0.0);
    }
  }

  void
  RestoreVolumes(double angleFloor, double slack)
  {
    VolumeKeeper::Parameters keep;
    keep.cosineFloor = std::cos(angleFloor);
    keep.slack = slack;
    m_Volumes.Restore(m_Complex, m_Mover, keep);
  }

  /** Puts the boundary on the right side of the centres of voxels, where these are known. */
  void
  RestoreSides()
  {
    if (m_Parameters.outline)
    {
      SideKeeper::Parameters keep;
      keep.cosineFloor = std::cos(SideAngle);
      SideKeeper(*m_Parameters.outline).Restore(m_Complex, m_Mover, keep);
    }
  }

  void
  Flip(double angle)
  {
    FlipParameters flips;
    flips.targetAngle = angle;
    const auto mark = [this](const FlipResult & flip) { m_Optimizer.Mark(flip.created); };
    m_Report.flips += ImproveByFlips(m_Complex, flips, mark, &m_FlipMemory).done;
  }

  void
  Refine()
  {
    // Of what is halved and collapsed next, no more than the worst cells is worth flips.
    Flip(m_Parameters.surfaceAngle);
    InteriorRefinement refinement(m_Complex, m_Repair, m_Parameters.gradation);
    m_Report.splits += refinement.Split(LongEdge);
    m_Report.splits += refinement.Split(LongEdge);
    Flip(m_Parameters.surfaceAngle);
    m_Report.collapses += refinement.Collapse(ShortEdge, LongEdge, std::cos(m_Parameters.repairAngle));
    Smooth(SmoothingsInRound, SurfaceMotion::None);
  }

  void
  Repair(double angle)
  {
    m_Report.repairs +=
      m_Repair.Run(std::cos(angle), [this](const std::vector<IdType> & cells) { m_Optimizer.Mark(cells); });
  }

  void
  ImproveWorst(double done, double share)
  {
    m_Optimizer.MarkAll();
    Flip(m_Parameters.targetAngle);
    Repair(m_Parameters.repairAngle);
    for (int pass = 0; pass < m_Parameters.optimizationPasses; ++pass)
    {
      Advance(done + share * pass / m_Parameters.optimizationPasses);
      m_Report.optimized += m_Optimizer.Run(std::cos(m_Parameters.targetAngle), std::cos(m_Parameters.surfaceAngle));
      Flip(m_Parameters.targetAngle);
      Repair(m_Parameters.repairAngle);
    }
  }

  /** Surfaces to contours or first surfaces, then what is inside to them, in turn. */
  void
  FitSurfacesAndInside()
  {
    // Between slices that the mesh has left out, contours may lie farther from it than its bound.
    SetBound(m_Parameters.sliverFactor * m_Parameters.distanceBound);
    double stiffness = m_Parameters.stiffness;
    int    passes = m_Parameters.fitPasses;
    for (int pass = 0; pass < passes; ++pass)
    {
      SurfaceFitParameters fit;
      fit.stiffness = stiffness;
      fit.cosineFloor = std::cos(m_Parameters.surfaceAngle);
      FitSurfaces(m_Complex, m_Mover, { m_First, m_Parameters.shape, m_Parameters.outline }, fit);
      if (m_Parameters.shape)
      {
        ChangeEdges(stiffness);
      }
      Smooth(SmoothingsInRound, SurfaceMotion::None);
      if (pass % FitsToFlip == 0 || pass + 1 == passes)
      {
        Flip(m_Parameters.targetAngle);
      }
      if (pass + 1 == passes)
      {
        RestoreSides();
      }
      if (pass + 1 == passes && passes < m_Parameters.fitPasses + m_Parameters.morePasses && IsRough())
      {
        stiffness *= StiffnessFactor;
        ++passes;
      }
    }
    RestoreVolumes(m_Parameters.surfaceAngle, m_Parameters.shape ? m_Parameters.volumeSlack : 0.0);
    RestoreSides();
    constexpr double noSurfaces = 1.0;
    m_Optimizer.MarkAll();
    m_Report.optimized += m_Optimizer.Run(std::cos(m_Parameters.targetAngle), noSurfaces);
    Flip(m_Parameters.lastAngle);
    SetBound(m_Parameters.distanceBound);
  }

  /** Whether the boundary turns by more than is wanted, and contours tell how smooth it may be. */
  bool
  IsRough() const
  {
    return m_Parameters.shape && m_Parameters.stiffness > 0 &&
           MeanBoundaryTurn(m_Complex, m_Parameters.slices) > m_Parameters.turnShare * m_FirstTurn;
  }

  /** Collapses and flips of surface edges by contours and turns. */
  void
  ChangeEdges(double stiffness)
  {
    const ContourSamples contours(m_Complex, *m_Parameters.shape);
    const SurfaceBending bending(m_Complex, stiffness);
    SurfaceEnergy        energy(m_Complex, contours, bending);
    SharpEdgeParameters  sharp;
    sharp.angle = m_Parameters.sharpAngle;
    sharp.cosineFloor = std::cos(m_Parameters.surfaceAngle);
    m_Report.sharpEdges += CollapseSharpEdges(m_Complex, m_Mover, m_Repair, energy, sharp);
    ContourFlipParameters flips;
    flips.leastGain = std::pow(m_Parameters.flipGain * m_Parameters.distanceBound, 2);
    flips.cosineFloor = std::cos(m_Parameters.surfaceAngle);
    m_Report.contourFlips += FlipToContours(m_Complex, m_Mover, energy, flips);
  }

  /** What no change within the bound has mended may go farther, and the worst cells farther still. */
  void
  MendSlivers()
  {
    MendBelow(m_Parameters.surfaceAngle, std::min(SurfaceFactor, m_Parameters.sliverFactor));
    MendBelow(m_Parameters.sliverAngle, m_Parameters.sliverFactor);
    SetBound(m_Parameters.distanceBound);
  }

  /** \param factor  distance bounds that surfaces may go. */
  void
  MendBelow(double angle, double factor)
  {
    const double limit = std::cos(angle);
    SetBound(factor * m_Parameters.distanceBound);
    m_Optimizer.MarkAll();
    for (int pass = 0; pass < SliverPasses; ++pass)
    {
      const std::size_t before = m_Report.repairs + m_Report.optimized;
      Repair(angle);
      m_Report.optimized += m_Optimizer.Run(limit, limit);
      if (m_Report.repairs + m_Report.optimized == before)
      {
        return;
      }
      Flip(m_Parameters.targetAngle);
    }
  }

  TetraComplex &                m_Complex;
  const ImprovementParameters & m_Parameters;
  const ProgressFunction &      m_Progress;
  double                        m_FirstTurn; ///< mean of the boundary as it was, rad
  SurfaceTarget                 m_First;     ///< the surfaces as they were
  SurfaceBound                  m_Bound;
  PointMover                    m_Mover;
  SurfaceTarget                 m_Target;
  VolumeKeeper                  m_Volumes;
  PointOptimizer                m_Optimizer;
  MeshRepair                    m_Repair;
  FlipMemory                    m_FlipMemory;
  ImprovementReport             m_Report;
};
} // namespace

ImprovementReport
ImproveMesh(TetraComplex & complex, const ImprovementParameters & parameters, const ProgressFunction & progress)
{
  ImprovementReport report = MeshImprover(complex, parameters, progress).Run();
  if (progress)
  {
    progress(1.0);
  }
  return report;
}
} // namespace bone
