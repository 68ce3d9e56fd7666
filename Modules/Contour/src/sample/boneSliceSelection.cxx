/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSliceSelection.h"

#include "bonePlaneField.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bone
{
namespace
{
constexpr int    GridNodes = 160; // along the longer side of the bone
constexpr double InnerWeight = 0.25;
constexpr double Infinity = std::numeric_limits<double>::infinity();

/** Signed distances to the contours of each slice. */
class SectionFields
{
public:
  SectionFields(const ContourStack & stack, std::size_t first, std::size_t last, const Execution & execution)
  {
    std::vector<std::vector<Polygon>> outer(last - first + 1), inner(outer.size());
    std::vector<Polygon>              all;
    for (std::size_t k = first; k <= last; ++k)
    {
      m_Height.push_back(stack.GetHeight(k));
      for (const Contour & contour : stack.GetSlices()[k].contours)
      {
        if (!contour.axis && contour.layer < 2)
        {
          Polygon polygon;
          for (const Vector3 & p : contour.points)
          {
            polygon.push_back(stack.ToPlane(p));
          }
          all.push_back(polygon);
          (contour.layer == 0 ? outer : inner)[k - first].push_back(std::move(polygon));
        }
      }
    }
    const PlaneGrid coarse = CoveringGrid(all, 0.0, Vector2::Zero(), Vector2::Ones());
    const double    spacing = std::max({ coarse.size[0], coarse.size[1], 1 }) / static_cast<double>(GridNodes);
    const PlaneGrid grid = CoveringGrid(all, 2.0 * spacing, Vector2::Zero(), Vector2::Constant(spacing));
    m_Pixel = spacing * spacing;
    m_Outer.resize(outer.size());
    m_Inner.resize(outer.size());
    execution.For(outer.size(), [&](std::size_t k) {
      m_Outer[k] = FieldOf(outer[k], grid);
      m_Inner[k] = FieldOf(inner[k], grid);
    });
  }

  std::size_t
  Size() const
  {
    return m_Height.size();
  }
  double
  Height(std::size_t k) const
  {
    return m_Height[k];
  }

  /** Volume misplaced where all between slices i and j are left out. */
  double
  Misplaced(std::size_t i, std::size_t j) const
  {
    double volume = 0.0;
    for (std::size_t k = i + 1; k < j; ++k)
    {
      const double share = (m_Height[k] - m_Height[i]) / (m_Height[j] - m_Height[i]);
      const double area = Difference(m_Outer[i], m_Outer[j], m_Outer[k], share) +
                          InnerWeight * Difference(m_Inner[i], m_Inner[j], m_Inner[k], share);
      volume += area * 0.5 * (m_Height[k + 1] - m_Height[k - 1]);
    }
    return volume;
  }

private:
  static std::vector<float>
  FieldOf(const std::vector<Polygon> & polygons, const PlaneGrid & grid)
  {
    if (polygons.empty())
    {
      // Far outside, but not so far that a single slice without contours empties its neighbours.
      const float away = -0.5F * static_cast<float>((grid.spacing.x() * GridNodes) / 8.0);
      return std::vector<float>(grid.Count(), away);
    }
    return ComputeDistanceField(polygons, grid).distance.values;
  }

  double
  Difference(const std::vector<float> & below,
             const std::vector<float> & above,
             const std::vector<float> & own,
             double                     share) const
  {
    const auto  s = static_cast<float>(share);
    std::size_t count = 0;
    for (std::size_t n = 0; n < own.size(); ++n)
    {
      count += (((1.0F - s) * below[n] + s * above[n]) > 0.0F) != (own[n] > 0.0F);
    }
    return static_cast<double>(count) * m_Pixel;
  }

  std::vector<double>             m_Height;
  double                          m_Pixel{ 1.0 };
  std::vector<std::vector<float>> m_Outer, m_Inner;
};

/** How many steps each slice may be followed by the next one kept. */
std::vector<std::size_t>
FarthestNext(const SectionFields & fields, double maximumGap)
{
  std::vector<std::size_t> farthest(fields.Size());
  for (std::size_t i = 0; i < fields.Size(); ++i)
  {
    farthest[i] = std::min(i + 1, fields.Size() - 1);
    while (farthest[i] + 1 < fields.Size() && fields.Height(farthest[i] + 1) - fields.Height(i) <= maximumGap)
    {
      ++farthest[i];
    }
  }
  return farthest;
}

std::size_t
LeastCount(const std::vector<std::size_t> & farthest)
{
  std::size_t count = 1;
  for (std::size_t i = 0; i + 1 < farthest.size(); i = farthest[i])
  {
    ++count;
  }
  return count;
}
} // namespace

SliceSelection
SelectSlices(const ContourStack & stack, std::size_t count, double maximumGap, const Execution & execution)
{
  const auto & slices = stack.GetSlices();
  std::size_t  first = 0, last = slices.size() - 1;
  while (first < last && slices[first].contours.empty())
  {
    ++first;
  }
  while (last > first && slices[last].contours.empty())
  {
    --last;
  }
  const SectionFields              fields(stack, first, last, execution.Part(0.0, 0.3));
  const std::size_t                size = fields.Size();
  const std::vector<std::size_t>   farthest = FarthestNext(fields, maximumGap);
  const std::size_t                kept = std::clamp(count, std::min(LeastCount(farthest), size), size);
  std::vector<std::vector<double>> cost(size);
  execution.Part(0.3, 1.0).For(size, [&](std::size_t i) {
    for (std::size_t j = i + 1; j <= farthest[i] && j < size; ++j)
    {
      cost[i].push_back(fields.Misplaced(i, j));
    }
  });
  // least[m][j]: of slices 0 to j, j the one numbered m of those kept.
  std::vector<std::vector<double>>      least(kept, std::vector<double>(size, Infinity));
  std::vector<std::vector<std::size_t>> before(kept, std::vector<std::size_t>(size, 0));
  least[0][0] = 0.0;
  for (std::size_t m = 1; m < kept; ++m)
  {
    for (std::size_t i = 0; i < size; ++i)
    {
      for (std::size_t j = i + 1; j <= farthest[i] && j < size && least[m - 1][i] < Infinity; ++j)
      {
        const double sum = least[m - 1][i] + cost[i][j - i - 1];
        if (sum < least[m][j])
        {
          least[m][j] = sum;
          before[m][j] = i;
        }
      }
    }
  }
  SliceSelection selection;
  selection.volume = least[kept - 1][size - 1];
  selection.slices.resize(kept);
  for (std::size_t m = kept, j = size - 1; m-- > 0; j = before[m][j])
  {
    selection.slices[m] = first + j;
  }
  return selection;
}
} // namespace bone
