/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourFlips.h"

#include "boneTetraFlips.h"

#include <algorithm>
#include <array>
#include <optional>

namespace bone
{
namespace
{
/** The two triangles on an edge, and those that a flip leaves. */
struct Rhombus
{
  std::array<IdType, 4>    points;
  std::vector<TriangleIds> before, after;
};

std::optional<Rhombus>
RhombusOn(const SurfaceEnergy & energy, const SurfaceEnergy::Edge & edge)
{
  const auto [a, b] = edge;
  const auto corners = energy.Corners(a, b);
  if (!corners)
  {
    return std::nullopt;
  }
  const auto [c, d] = *corners;
  return Rhombus{ { a, b, c, d }, { { a, b, c }, { a, b, d } }, { { a, c, d }, { b, c, d } } };
}

/** The triangles on the edge, where the energy falls enough when it is flipped. */
std::optional<SurfaceEnergy::Patch>
FindGain(const SurfaceEnergy & energy, const Rhombus & rhombus, double leastGain)
{
  auto       patch = energy.At(rhombus.before);
  const bool gains = patch.samples.size() >= 2 && energy.Change(patch, rhombus.after) < -leastGain * patch.area;
  return gains ? std::make_optional(std::move(patch)) : std::nullopt;
}

/** Whether the edge was flipped. \param isChanged  of points: set for those of the cells that are replaced. */
bool
Flip(TetraComplex &                complex,
     PointMover &                  mover,
     SurfaceEnergy &               energy,
     const Rhombus &               rhombus,
     const ContourFlipParameters & parameters,
     std::vector<char> &           isChanged)
{
  const auto patch = FindGain(energy, rhombus, parameters.leastGain);
  if (!patch)
  {
    return false;
  }
  const auto &      before = rhombus.before, &after = rhombus.after;
  const SurfaceFlip plan = PlanSurfaceFlip(complex, rhombus.points[0], rhombus.points[1], parameters.cosineFloor);
  const int         f = plan.surface;
  if (plan.outcome != MeshOperation::Done ||
      !mover.ReplaceSurface({ { before[0], f }, { before[1], f } }, { { after[0], f }, { after[1], f } }))
  {
    return false;
  }
  energy.Replace(*patch, after);
  for (IdType t : plan.removed)
  {
    for (IdType p : complex.Cell(t))
    {
      isChanged[p] = 1;
    }
  }
  complex.ReplaceAcross(plan.removed, plan.created, plan.regions, plan.surface);
  return true;
}
} // namespace

std::size_t
FlipToContours(TetraComplex &                complex,
               PointMover &                  mover,
               SurfaceEnergy &               energy,
               const ContourFlipParameters & parameters,
               const Execution &             execution)
{
  // What an edge would gain depends on the triangles next to its own, too: where one of them is flipped, two of its
  // points are of that flip.
  constexpr std::size_t                  chunk = 64;
  const auto                             found = energy.Edges();
  const std::vector<SurfaceEnergy::Edge> edges(found.begin(), found.end());
  std::vector<std::optional<Rhombus>>    rhombi(edges.size());
  std::vector<char>                      gains(edges.size(), 0), isChanged(complex.Points().size(), 0);
  execution.For(
    edges.size(),
    [&](std::size_t e) {
      rhombi[e] = RhombusOn(energy, edges[e]);
      gains[e] = rhombi[e] && FindGain(energy, *rhombi[e], parameters.leastGain);
    },
    chunk);
  const auto  isNew = [&](IdType p) { return isChanged[p] != 0; };
  std::size_t count = 0;
  for (std::size_t e = 0; e < edges.size(); ++e)
  {
    const bool endsAreNew = isNew(edges[e].first) || isNew(edges[e].second);
    const auto rhombus = endsAreNew ? RhombusOn(energy, edges[e]) : rhombi[e];
    if (rhombus && (gains[e] || std::any_of(rhombus->points.begin(), rhombus->points.end(), isNew)))
    {
      count += Flip(complex, mover, energy, *rhombus, parameters, isChanged) ? 1 : 0;
    }
  }
  return count;
}
} // namespace bone
