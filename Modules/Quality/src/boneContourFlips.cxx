/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneContourFlips.h"

#include "boneTetraFlips.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

namespace bone
{
namespace
{
using Samples = std::vector<const ContourShape::Sample *>;

class ContourFlipper
{
public:
  ContourFlipper(TetraComplex &                complex,
                 PointMover &                  mover,
                 const ContourSamples &        contours,
                 const SurfaceBending &        bending,
                 const ContourFlipParameters & parameters)
    : m_Complex(complex)
    , m_Mover(mover)
    , m_Bending(bending)
    , m_Parameters(parameters)
  {
    for (const ContourSamples::Match & match : contours.FindMatches(complex))
    {
      m_Samples[Ascending(match.triangle)].push_back(match.sample);
    }
  }

  /** Edges of triangles that contours belong to, ascending. */
  std::set<std::pair<IdType, IdType>>
  Edges() const
  {
    std::set<std::pair<IdType, IdType>> edges;
    for (const auto & entry : m_Samples)
    {
      const TriangleIds & t = entry.first;
      edges.insert({ { t[0], t[1] }, { t[0], t[2] }, { t[1], t[2] } });
    }
    return edges;
  }

  /** Whether the edge was flipped. */
  bool
  Flip(IdType a, IdType b)
  {
    const auto corners = Corners(a, b);
    if (!corners)
    {
      return false;
    }
    const auto [c, d] = *corners;
    const Pair before{ { Ascending({ a, b, c }), Ascending({ a, b, d }) } };
    const Pair after{ { Ascending({ a, c, d }), Ascending({ b, c, d }) } };
    Samples    samples = m_Samples[before[0]];
    samples.insert(samples.end(), m_Samples[before[1]].begin(), m_Samples[before[1]].end());
    if (!IsBetter(samples, { { a, b, c, d } }))
    {
      return false;
    }
    const SurfaceFlip plan = PlanSurfaceFlip(m_Complex, a, b, m_Parameters.cosineFloor);
    const int         f = plan.surface;
    if (plan.outcome != MeshOperation::Done ||
        !m_Mover.ReplaceSurface({ { { a, b, c }, f }, { { a, b, d }, f } }, { { { a, c, d }, f }, { { b, c, d }, f } }))
    {
      return false;
    }
    m_Samples.erase(before[0]);
    m_Samples.erase(before[1]);
    for (const ContourShape::Sample * sample : samples)
    {
      const bool second = SquaredDistance(*sample, after[1]) < SquaredDistance(*sample, after[0]);
      m_Samples[after[second]].push_back(sample);
    }
    m_Complex.ReplaceAcross(plan.removed, plan.created, plan.regions, plan.surface);
    return true;
  }

private:
  using Pair = std::array<TriangleIds, 2>;

  /** Third points of the two surface triangles at an edge; none where there are others. */
  std::optional<std::array<IdType, 2>>
  Corners(IdType a, IdType b) const
  {
    std::array<IdType, 2> corners{};
    int                   count = 0;
    for (IdType t : m_Complex.EdgeStar(a, b))
    {
      const Id4 & cell = m_Complex.Cell(t);
      for (int i = 0; i < 4; ++i)
      {
        if (cell[i] != a && cell[i] != b && m_Complex.Carries(t, i))
        {
          const IdType third = cell[0] + cell[1] + cell[2] + cell[3] - a - b - cell[i];
          corners[std::min(count++, 1)] = third;
        }
      }
    }
    return count == 2 ? std::make_optional(corners) : std::nullopt;
  }

  double
  SquaredDistance(const ContourShape::Sample & sample, const TriangleIds & t) const
  {
    const auto & x = m_Complex.Points();
    return (ClosestPointOnTriangle(sample.place, x[t[0]], x[t[1]], x[t[2]]) - sample.place).squaredNorm();
  }

  double
  Bending(IdType a, IdType b, IdType c, IdType d) const
  {
    const auto & x = m_Complex.Points();
    return m_Bending.Energy(x[a], x[b], x[c], x[d]);
  }

  /** By how much the bending of a quadrangle's edges falls where its diagonal (a, b) becomes (c, d). */
  double
  BendingGain(const std::array<IdType, 4> & quadrangle) const
  {
    const auto [a, b, c, d] = quadrangle;
    // Sides, the corner that they lose and the one that they get.
    const std::array<IdType, 4> sides[4] = {
      { { a, c, b, d } }, { { b, c, a, d } }, { { a, d, b, c } }, { { b, d, a, c } }
    };
    double gain = Bending(a, b, c, d) - Bending(c, d, a, b);
    for (const auto & [p, q, lost, gained] : sides)
    {
      if (const auto corners = Corners(p, q))
      {
        const IdType beyond = (*corners)[0] == lost ? (*corners)[1] : (*corners)[0];
        gain += Bending(p, q, lost, beyond) - Bending(p, q, gained, beyond);
      }
    }
    return gain;
  }

  bool
  IsBetter(const Samples & samples, const std::array<IdType, 4> & quadrangle) const
  {
    const auto [a, b, c, d] = quadrangle;
    const Pair before{ { { a, b, c }, { a, b, d } } }, after{ { { a, c, d }, { b, c, d } } };
    double     weight = 0.0, old = 0.0, made = 0.0;
    for (const ContourShape::Sample * sample : samples)
    {
      weight += sample->weight;
      old += sample->weight * std::min(SquaredDistance(*sample, before[0]), SquaredDistance(*sample, before[1]));
      made += sample->weight * std::min(SquaredDistance(*sample, after[0]), SquaredDistance(*sample, after[1]));
    }
    return samples.size() > 1 && old - made + BendingGain(quadrangle) > m_Parameters.leastGain * weight;
  }

  TetraComplex &                 m_Complex;
  PointMover &                   m_Mover;
  const SurfaceBending &         m_Bending;
  const ContourFlipParameters &  m_Parameters;
  std::map<TriangleIds, Samples> m_Samples; ///< of each triangle, its ids ascending
};
} // namespace

std::size_t
FlipToContours(TetraComplex &                complex,
               PointMover &                  mover,
               const ContourSamples &        contours,
               const SurfaceBending &        bending,
               const ContourFlipParameters & parameters)
{
  ContourFlipper flipper(complex, mover, contours, bending, parameters);
  std::size_t    count = 0;
  for (const auto & [a, b] : flipper.Edges())
  {
    count += flipper.Flip(a, b) ? 1 : 0;
  }
  return count;
}
} // namespace bone
