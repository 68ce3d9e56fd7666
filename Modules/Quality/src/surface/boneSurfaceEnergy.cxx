/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSurfaceEnergy.h"

#include <algorithm>
#include <limits>

namespace bone
{
SurfaceEnergy::SurfaceEnergy(const TetraComplex &   complex,
                             const ContourSamples & contours,
                             const SurfaceBending & bending)
  : m_Complex(complex)
  , m_Bending(bending)
{
  for (const ContourSamples::Match & match : contours.FindMatches(complex))
  {
    m_Samples[Ascending(match.triangle)].push_back(match.sample);
  }
}

std::set<SurfaceEnergy::Edge>
SurfaceEnergy::Edges() const
{
  std::set<Edge> edges;
  for (const auto & entry : m_Samples)
  {
    const TriangleIds & t = entry.first;
    edges.insert({ { t[0], t[1] }, { t[0], t[2] }, { t[1], t[2] } });
  }
  return edges;
}

std::optional<std::array<IdType, 2>>
SurfaceEnergy::Corners(IdType a, IdType b) const
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
SurfaceEnergy::Deviation(IdType a, IdType b) const
{
  const auto & x = m_Complex.Points();
  const auto   corners = Corners(a, b);
  return corners ? DihedralDeviation(x[a], x[b], x[(*corners)[0]], x[(*corners)[1]]) : 0.0;
}

SurfaceEnergy::Samples
SurfaceEnergy::SamplesOf(const std::vector<TriangleIds> & triangles) const
{
  Samples samples;
  for (const TriangleIds & t : triangles)
  {
    const auto found = m_Samples.find(Ascending(t));
    if (found != m_Samples.end())
    {
      samples.insert(samples.end(), found->second.begin(), found->second.end());
    }
  }
  return samples;
}

/** Calls visit(edge, third point) for the three edges of each triangle. */
template <typename TVisit>
static void
ForEachCorner(const std::vector<TriangleIds> & triangles, TVisit visit)
{
  for (const TriangleIds & t : triangles)
  {
    for (int i = 0; i < 3; ++i)
    {
      visit(SurfaceEnergy::Edge(std::minmax(t[i], t[(i + 1) % 3])), t[(i + 2) % 3]);
    }
  }
}

/** Corners, beyond the rim of some triangles, of those next to them. */
std::vector<SurfaceEnergy::Corner>
SurfaceEnergy::CornersBeyond(const std::vector<TriangleIds> & triangles) const
{
  std::vector<Corner> own, beyond;
  ForEachCorner(triangles, [&](const Edge & edge, IdType corner) { own.emplace_back(edge, corner); });
  std::sort(own.begin(), own.end());
  for (std::size_t i = 0; i < own.size(); ++i)
  {
    const Edge & edge = own[i].first;
    const bool   single = (i == 0 || own[i - 1].first != edge) && (i + 1 == own.size() || own[i + 1].first != edge);
    const auto   corners = single ? Corners(edge.first, edge.second) : std::nullopt;
    if (corners)
    {
      beyond.emplace_back(edge, (*corners)[0] == own[i].second ? (*corners)[1] : (*corners)[0]);
    }
  }
  return beyond;
}

double
SurfaceEnergy::SquaredDistance(const ContourShape::Sample & sample, const TriangleIds & t) const
{
  const auto & x = m_Complex.Points();
  return (ClosestPointOnTriangle(sample.place, x[t[0]], x[t[1]], x[t[2]]) - sample.place).squaredNorm();
}

/** Of triangles in the place of a patch; a part of it where that is `enough`. */
double
SurfaceEnergy::Energy(const Patch & patch, const std::vector<TriangleIds> & triangles, double enough) const
{
  const auto &        x = m_Complex.Points();
  std::vector<Corner> corners = patch.beyond;
  ForEachCorner(triangles, [&](const Edge & edge, IdType corner) { corners.emplace_back(edge, corner); });
  std::sort(corners.begin(), corners.end());
  double energy = 0.0;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i)
  {
    const auto & [edge, corner] = corners[i];
    if (corners[i + 1].first == edge)
    {
      energy += m_Bending.Energy(x[edge.first], x[edge.second], x[corner], x[corners[i + 1].second]);
    }
  }
  for (const ContourShape::Sample * sample : patch.samples)
  {
    if (energy >= enough)
    {
      break;
    }
    double least = std::numeric_limits<double>::max();
    for (const TriangleIds & t : triangles)
    {
      least = std::min(least, SquaredDistance(*sample, t));
    }
    energy += sample->weight * least;
  }
  return energy;
}

SurfaceEnergy::Patch
SurfaceEnergy::At(const std::vector<TriangleIds> & triangles) const
{
  Patch patch{ triangles, CornersBeyond(triangles), SamplesOf(triangles), 0.0, 0.0 };
  for (const ContourShape::Sample * sample : patch.samples)
  {
    patch.area += sample->weight;
  }
  patch.energy = Energy(patch, triangles, std::numeric_limits<double>::max());
  return patch;
}

double
SurfaceEnergy::Change(const Patch & patch, const std::vector<TriangleIds> & added) const
{
  return Energy(patch, added, patch.energy) - patch.energy;
}

void
SurfaceEnergy::Replace(const Patch & patch, const std::vector<TriangleIds> & added)
{
  for (const TriangleIds & t : patch.triangles)
  {
    m_Samples.erase(Ascending(t));
  }
  for (const ContourShape::Sample * sample : patch.samples)
  {
    const auto nearer = [&](const TriangleIds & a, const TriangleIds & b) {
      return SquaredDistance(*sample, a) < SquaredDistance(*sample, b);
    };
    m_Samples[Ascending(*std::min_element(added.begin(), added.end(), nearer))].push_back(sample);
  }
}
} // namespace bone
