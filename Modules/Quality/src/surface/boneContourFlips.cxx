/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourFlips.h"

#include "boneTetraFlips.h"

namespace bone
{
namespace
{
/** Whether the edge was flipped. */
bool
Flip(TetraComplex &                complex,
     PointMover &                  mover,
     SurfaceEnergy &               energy,
     const SurfaceEnergy::Edge &   edge,
     const ContourFlipParameters & parameters)
{
  const auto [a, b] = edge;
  const auto corners = energy.Corners(a, b);
  if (!corners)
  {
    return false;
  }
  const auto [c, d] = *corners;
  const std::vector<TriangleIds> before = { { a, b, c }, { a, b, d } }, after = { { a, c, d }, { b, c, d } };
  const auto                     patch = energy.At(before);
  if (patch.samples.size() < 2 || !(energy.Change(patch, after) < -parameters.leastGain * patch.area))
  {
    return false;
  }
  const SurfaceFlip plan = PlanSurfaceFlip(complex, a, b, parameters.cosineFloor);
  const int         f = plan.surface;
  if (plan.outcome != MeshOperation::Done ||
      !mover.ReplaceSurface({ { before[0], f }, { before[1], f } }, { { after[0], f }, { after[1], f } }))
  {
    return false;
  }
  energy.Replace(patch, after);
  complex.ReplaceAcross(plan.removed, plan.created, plan.regions, plan.surface);
  return true;
}
} // namespace

std::size_t
FlipToContours(TetraComplex &                complex,
               PointMover &                  mover,
               SurfaceEnergy &               energy,
               const ContourFlipParameters & parameters)
{
  std::size_t count = 0;
  for (const auto & edge : energy.Edges())
  {
    count += Flip(complex, mover, energy, edge, parameters) ? 1 : 0;
  }
  return count;
}
} // namespace bone
