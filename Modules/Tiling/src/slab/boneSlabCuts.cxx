/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSlabCuts.h"

#include "boneSectionBuilder.h"

namespace bone
{
namespace tiling
{
double
PieceCut::DistanceToCut(const Vector2 & q) const
{
  double nearest = Infinity, next = Infinity;
  for (const ContourDistance & counterpart : counterparts)
  {
    const double distance = counterpart.At(q);
    next = std::min(next, std::max(nearest, distance));
    nearest = std::min(nearest, distance);
  }
  return 0.5 * (next - nearest);
}

std::vector<PieceCut>
FindPieceCuts(const VertexPool &           pool,
              const std::vector<Section> & lower,
              const std::vector<Section> & upper,
              const std::vector<Group> &   groups,
              const Vector2 &              shift)
{
  std::vector<PieceCut> cuts;
  for (std::size_t g = 0; g < groups.size(); ++g)
  {
    const std::size_t below = groups[g].lower.size(), above = groups[g].upper.size();
    if (below + above < 3 || (below != 1 && above != 1) || below == 0 || above == 0)
    {
      continue;
    }
    PieceCut cut{ below == 1 ? 0 : 1, static_cast<int>(g), {} };
    for (int i : cut.side == 0 ? groups[g].upper : groups[g].lower)
    {
      const Vector2 move = cut.side == 0 ? Vector2(-shift) : Vector2(Vector2::Zero());
      cut.counterparts.emplace_back(OuterPolygon(pool.plane, (cut.side == 0 ? upper : lower)[i]), move);
    }
    cuts.push_back(std::move(cut));
  }
  return cuts;
}

CutDistances
MeasureCuts(const std::vector<PieceCut> &           cuts,
            const std::array<const SlabSide *, 2> & sides,
            const PlanarOverlay &                   overlay)
{
  CutDistances distances;
  distances.fill(std::vector<double>(overlay.points.size(), Infinity));
  for (const PieceCut & cut : cuts)
  {
    std::vector<double> & here = distances[cut.side];
    for (const auto & triangle : overlay.triangles)
    {
      if (sides[cut.side]->group[cut.side == 0 ? triangle.first : triangle.second] != cut.group)
      {
        continue;
      }
      for (int v : triangle.vertices)
      {
        here[v] = here[v] < Infinity ? here[v] : cut.DistanceToCut(overlay.points[v]);
      }
    }
  }
  return distances;
}
} // namespace tiling
} // namespace bone
