/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneEnhancedSmoothing.h"

#include "boneVolumeKeeper.h"

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

} // namespace

void
EnhancedIteration(TetraComplex &                   complex,
                  PointMover &                     mover,
                  const SurfaceTarget &            target,
                  const TetraSmoothingParameters & parameters,
                  SurfaceMotion                    motion,
                  SmoothingReport &                report)
{
  const double cosineFloor = std::cos(parameters.angleFloor);
  for (IdType p = 0; p < static_cast<IdType>(complex.Points().size()); ++p)
  {
    if (complex.Star(p).empty() || complex.Dimension(p) == 0 ||
        (motion == SurfaceMotion::None && complex.Dimension(p) < 3))
    {
      continue;
    }
    const Vector3 old = complex.Points()[p];
    const bool    atFaired = motion == SurfaceMotion::ToFairedPlace && complex.Dimension(p) < 3;
    Vector3       x =
      atFaired ? target.Faired(p) : target.Place(complex, p, MeanOf(complex.Points(), StratumNeighbors(complex, p)));
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
SmoothPoints(TetraComplex & complex, const TetraSmoothingParameters & parameters, const Execution & execution)
{
  SmoothingReport report;
  PointMover      mover(complex, nullptr, execution);
  const bool      enhanced = parameters.method == SmoothingMethod::Enhanced;
  SurfaceTarget   target(complex, parameters.distanceBound, enhanced ? parameters.fairingIterations : 0);
  SurfaceTarget   first(complex, 0.0, 0);
  VolumeKeeper    volumes(complex);
  for (int i = 0; i < parameters.iterations; ++i)
  {
    if (enhanced)
    {
      EnhancedIteration(complex, mover, target, parameters, SurfaceMotion::Slide, report);
    }
    else
    {
      PlainIteration(complex, mover, parameters.method == SmoothingMethod::Smart, report);
    }
    execution.Report(static_cast<double>(i + 1) / (parameters.iterations + 1));
  }
  if (enhanced && parameters.iterations > 0)
  {
    const double             bound = parameters.distanceBound * parameters.distanceBound;
    VolumeKeeper::Parameters keep;
    keep.cosineFloor = std::cos(parameters.angleFloor);
    keep.limit = [&](IdType p, const Vector3 & x) { return (first.Project(complex, p, x) - x).squaredNorm() <= bound; };
    volumes.Restore(complex, mover, keep);
  }
  return report;
}
} // namespace bone
