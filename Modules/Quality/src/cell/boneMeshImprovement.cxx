/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMeshImprovement.h"

#include "boneContourFlips.h"
#include "boneEnhancedSmoothing.h"
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
/** Edges longer than this many sizes are halved, those shorter than ShortEdge collapsed. */
constexpr double LongEdge = 1.5;
constexpr double ShortEdge = 0.6;
/** Where edges are halved next, collapses may leave longer ones. */
constexpr double LongestHalved = 2.0 * LongEdge;
/** Of the distance bound: shorter edges are accidents of the input. */
constexpr double TinyEdge = 1e-3;
constexpr int    SmoothingsInRound = 2;
constexpr int    SliverPasses = 2;
/** Fits of surfaces between two of flips inside. */
constexpr int FitsToFlip = 2;
/** Fits from this many before the last may be stiffer than the first. */
constexpr int FirstStiffer = 2;
/** Stiffness rises from one fit to the next by this power of the boundary's dihedral deviation over the wanted one ...
 */
constexpr double StiffnessPower = 4.0;
/** ... but by no less than this share, twice that, and so on, and by no more than this factor ... */
constexpr double LeastStiffening = 0.1;
constexpr double MostStiffening = 3.0;
/** ... up to so many times the first: beyond, bodies that are smooth from the start are made flat. */
constexpr double MostStiffness = 4.0;
/** Smallest angle, rad, that points may leave where they are put on the right side of voxels. */
constexpr double SideAngle = 0.13;
/** Distance bounds that a curve may lose: the rim of a cut is not fitted to contours later. */
constexpr double CurveBound = 0.2;
/** Distance bounds that surfaces may go to mend cells below surfaceAngle. */
constexpr double SurfaceFactor = 1.5;

class MeshImprover
{
public:
  MeshImprover(TetraComplex & complex, const ImprovementParameters & parameters, const Execution & execution)
    : m_Complex(complex)
    , m_Parameters(parameters)
    , m_Execution(execution)
    , m_FirstDeviation(MeanBoundaryDeviation(complex, parameters.slices))
    , m_First(complex, 0.0, 0)
    , m_Bound(complex, m_First, parameters.distanceBound)
    , m_Mover(complex, &m_Bound, execution)
    , m_Target(complex, parameters.distanceBound, parameters.fairingIterations)
    , m_Volumes(complex)
    , m_Optimizer(complex, m_Mover, m_Target)
    , m_Repair(complex, m_Mover, CurveBound * parameters.distanceBound)
  {}

  ImprovementReport
  Run()
  {
    m_Report.repairs += m_Repair.CollapseShort(TinyEdge * m_Parameters.distanceBound);
    Smooth(m_Parameters.iterations, SurfaceMotion::ToFairedPlace);
    m_Execution.Report(0.1);
    for (int round = 0; round < m_Parameters.rounds; ++round)
    {
      const Execution part =
        m_Execution.Part(0.1 + 0.6 * round / m_Parameters.rounds, 0.1 + 0.6 * (round + 1) / m_Parameters.rounds);
      Smooth(SmoothingsInRound, SurfaceMotion::None);
      part.Report(0.1);
      if (round + 1 < m_Parameters.rounds && m_Parameters.gradation > 0)
      {
        Refine();
      }
      part.Report(0.4);
      RestoreVolumes(m_Parameters.surfaceAngle, 0.0);
      part.Report(0.5);
      ImproveWorst(part.Part(0.5, 0.8));
      MendSlivers();
      part.Report(1.0);
    }
    FitSurfacesAndInside();
    return m_Report;
  }

private:
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
    const TetraSmoothingParameters smoothing;
    for (int i = 0; i < iterations; ++i)
    {
      EnhancedIteration(m_Complex, m_Mover, m_Target, smoothing, motion, m_Report.smoothing);
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
      SideKeeper(*m_Parameters.outline).Restore(m_Complex, m_Mover, keep, m_Execution.Silent());
    }
  }

  void
  Flip(double angle)
  {
    FlipParameters flips;
    flips.targetAngle = angle;
    const auto mark = [this](const FlipResult & flip) { m_Optimizer.Mark(flip.created); };
    m_Report.flips += ImproveByFlips(m_Complex, flips, mark, &m_FlipMemory, m_Execution.Silent()).done;
  }

  void
  Refine()
  {
    // Of what is halved and collapsed next, no more than the worst cells is worth flips.
    Flip(m_Parameters.surfaceAngle);
    InteriorRefinement refinement(m_Complex, m_Repair, m_Parameters.gradation);
    m_Report.splits += refinement.Split(LongEdge);
    // What fans leave close together goes before it is halved once more.
    m_Report.collapses += refinement.Collapse(ShortEdge, LongestHalved, std::cos(m_Parameters.repairAngle));
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
  ImproveWorst(const Execution & execution)
  {
    m_Optimizer.MarkAll();
    Flip(m_Parameters.targetAngle);
    Repair(m_Parameters.repairAngle);
    for (int pass = 0; pass < m_Parameters.optimizationPasses; ++pass)
    {
      execution.Report(static_cast<double>(pass) / m_Parameters.optimizationPasses);
      m_Report.optimized += m_Optimizer.Run(std::cos(m_Parameters.targetAngle), std::cos(m_Parameters.surfaceAngle));
      Flip(m_Parameters.targetAngle);
      Repair(m_Parameters.repairAngle);
    }
  }

  /** Surfaces to contours or first surfaces, then what is inside to them, in passes. */
  void
  FitSurfacesAndInside()
  {
    // Between slices that the mesh has left out, contours may lie farther from it than its bound.
    SetBound(m_Parameters.sliverFactor * m_Parameters.distanceBound);
    const int most = m_Parameters.fitPasses + m_Parameters.morePasses;
    int       passes = m_Parameters.fitPasses;
    double    stiffness = m_Parameters.stiffness;
    for (int pass = 0; pass < passes; ++pass)
    {
      FitOnce(stiffness);
      m_Execution.Report(0.7 + 0.25 * (pass + 1) / most);
      const bool isLast = pass + 1 == passes;
      if (isLast || pass % FitsToFlip == 0)
      {
        Flip(m_Parameters.targetAngle);
      }
      double excess = Excess();
      if (isLast && (passes == most || !(excess > 1.0)))
      {
        RestoreSides();
        excess = Excess();
      }
      const int stiffer = pass + FirstStiffer - m_Parameters.fitPasses + 1;
      if (excess > 1.0 && stiffer > 0)
      {
        stiffness = Stiffen(stiffness, excess, 1.0 + LeastStiffening * stiffer);
        passes += isLast && passes < most ? 1 : 0;
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

  void
  FitOnce(double stiffness)
  {
    SurfaceFitParameters fit;
    fit.stiffness = stiffness;
    fit.cosineFloor = std::cos(m_Parameters.surfaceAngle);
    FitSurfaces(m_Complex, m_Mover, { m_First, m_Parameters.shape, m_Parameters.outline }, fit, m_Execution.Silent());
    if (m_Parameters.shape)
    {
      ChangeEdges(stiffness);
    }
    Smooth(SmoothingsInRound, SurfaceMotion::None);
  }

  /** Stiffness of the next fit. \param least  factor. */
  double
  Stiffen(double stiffness, double excess, double least) const
  {
    const double factor = std::min(std::max(std::pow(excess, StiffnessPower), least), MostStiffening);
    return std::min(stiffness * factor, MostStiffness * m_Parameters.stiffness);
  }

  /** The boundary's mean dihedral deviation over the wanted one; 0 where contours do not tell how smooth it may be. */
  double
  Excess() const
  {
    const bool known = m_Parameters.shape && m_Parameters.stiffness > 0 && m_FirstDeviation > 0;
    return known
             ? MeanBoundaryDeviation(m_Complex, m_Parameters.slices) / (m_Parameters.deviationShare * m_FirstDeviation)
             : 0.0;
  }

  /** Collapses and flips of surface edges by contours and dihedral deviation. */
  void
  ChangeEdges(double stiffness)
  {
    const ContourSamples contours(m_Complex, *m_Parameters.shape, m_Execution.Silent());
    const SurfaceBending bending(m_Complex, stiffness);
    SurfaceEnergy        energy(m_Complex, contours, bending);
    SharpEdgeParameters  sharp;
    sharp.angle = m_Parameters.sharpAngle;
    sharp.cosineFloor = std::cos(m_Parameters.surfaceAngle);
    m_Report.sharpEdges += CollapseSharpEdges(m_Complex, m_Mover, m_Repair, energy, sharp);
    ContourFlipParameters flips;
    flips.leastGain = std::pow(m_Parameters.flipGain * m_Parameters.distanceBound, 2);
    flips.cosineFloor = std::cos(m_Parameters.surfaceAngle);
    m_Report.contourFlips += FlipToContours(m_Complex, m_Mover, energy, flips, m_Execution.Silent());
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
  const Execution &             m_Execution;
  double                        m_FirstDeviation; ///< mean of the boundary as it was, rad
  SurfaceTarget                 m_First;          ///< the surfaces as they were
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
ImproveMesh(TetraComplex & complex, const ImprovementParameters & parameters, const Execution & execution)
{
  return MeshImprover(complex, parameters, execution).Run();
}
} // namespace bone
