/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCorticalProfile.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace bone
{
namespace
{
constexpr double LevelReach = 3.0;    // mm: over which the level inside is taken
constexpr double PeakReach = 3.0;     // mm, or pixels: how deep the cortex's maximum is sought
constexpr double ResolvedWidth = 3.5; // pixels: of a cortex whose maximum is not lowered by blur
constexpr double DistinctWidth = 5.0; // standard deviations: from there on blur does not change a layer's width

double
Normal(double x)
{
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

double
Median(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Width at half maximum of a layer of the given thickness, both in standard deviations of its blur.
double
BlurredWidth(double thickness)
{
  const double half = 0.5 * thickness;
  const double level = Normal(half) - 0.5; // half of the maximum
  double       low = 0.0;
  double       high = half + 2.0;
  for (int i = 0; i < 50; ++i)
  {
    const double x = 0.5 * (low + high);
    (Normal(x + half) - Normal(x - half) > level ? low : high) = x;
  }
  return low + high;
}

class EdgeFinder
{
public:
  EdgeFinder(const CorticalProfile & profile, const CorticalRules & rules)
    : m_Profile(profile)
    , m_Values(profile.values)
    , m_Rules(rules)
    , m_Count(static_cast<int>(profile.values.size()))
  {}

  CorticalEdges
  Find()
  {
    CorticalEdges edges;
    const double  reach = std::max(PeakReach, PeakReach * m_Rules.pixel);
    const int     window = std::min(m_Count - m_Profile.lead, static_cast<int>(reach / m_Profile.step) + 1);
    if (window < 2)
    {
      return edges;
    }
    const auto begin = m_Values.begin() + m_Profile.lead;
    // The first sample that is as good as the highest: on a plateau rounding would choose.
    const double highest = *std::max_element(begin, begin + window) - 0.5;
    m_Peak = static_cast<int>(
      std::find_if(begin, begin + window, [highest](double value) { return value >= highest; }) - m_Values.begin());
    double threshold = m_Rules.endostealThreshold;
    if (!(threshold > 0.0))
    {
      std::vector<double> rest(m_Values.begin() + m_Peak, m_Values.end());
      const auto          low = rest.begin() + static_cast<std::ptrdiff_t>(rest.size() / 5);
      std::nth_element(rest.begin(), low, rest.end());
      if (this->PeakValue() - *low < m_Rules.minimumContrast)
      {
        edges.kind = *low > m_Rules.solidLevel ? CorticalEdges::Kind::Solid : CorticalEdges::Kind::None;
        return edges;
      }
      threshold = 0.5 * (this->PeakValue() + *low);
    }
    if (this->PeakValue() < threshold)
    {
      return edges;
    }
    const int end = this->LocalEnd(threshold);
    if (end + 1 >= m_Count)
    {
      edges.kind = CorticalEdges::Kind::Solid;
      return edges;
    }
    edges.kind = CorticalEdges::Kind::Found;
    edges.inner = this->Crossing(end, end + 1, threshold);
    this->FindOuter(edges);
    return edges;
  }

private:
  double
  PeakValue() const
  {
    return m_Values[static_cast<std::size_t>(m_Peak)];
  }

  double
  At(int k) const
  {
    return m_Values[static_cast<std::size_t>(k)];
  }

  double
  Crossing(int above, int below, double level) const
  {
    const double fraction = (this->At(above) - level) / (this->At(above) - this->At(below));
    return (above + fraction * (below - above) - m_Profile.lead) * m_Profile.step;
  }

  // The last sample from the peak inward that is not below the level.
  int
  Fall(double level) const
  {
    int at = m_Peak;
    while (at + 1 < m_Count && !(this->At(at + 1) < level))
    {
      ++at;
    }
    return at;
  }

  // The level inside is taken again just within the end found: further in may be marrow.
  int
  LocalEnd(double & threshold) const
  {
    int end = this->Fall(threshold);
    for (int pass = 0; pass < 2 && !(m_Rules.endostealThreshold > 0.0) && end + 1 < m_Count; ++pass)
    {
      const int from = std::min(m_Count, end + static_cast<int>(1.2 * m_Rules.pixel / m_Profile.step));
      const int to = std::min(m_Count, from + static_cast<int>(LevelReach / m_Profile.step));
      if (to < from + 3)
      {
        break;
      }
      const double low = Median({ m_Values.begin() + from, m_Values.begin() + to });
      if (this->PeakValue() - low < m_Rules.minimumContrast)
      {
        break;
      }
      threshold = 0.5 * (this->PeakValue() + low);
      end = this->Fall(threshold);
    }
    return end;
  }

  void
  FindOuter(CorticalEdges & edges) const
  {
    if (m_Profile.lead < 3)
    {
      return;
    }
    const double outside = Median({ m_Values.begin(), m_Values.begin() + m_Profile.lead / 2 });
    const double level =
      m_Rules.endostealThreshold > 0.0 ? m_Rules.endostealThreshold : 0.5 * (this->PeakValue() + outside);
    int    at = m_Peak;
    double slope = 0.0;
    while (at > 0 && !(this->At(at - 1) < level))
    {
      --at;
    }
    if (at == 0)
    {
      return;
    }
    edges.outer = this->Crossing(at, at - 1, level);
    for (int k = std::max(1, at - 2); k <= std::min(m_Count - 2, at + 1); ++k)
    {
      slope = std::max(slope, 0.5 * (this->At(k + 1) - this->At(k - 1)) / m_Profile.step);
    }
    if (edges.inner - edges.outer > ResolvedWidth * m_Rules.pixel && slope > 0.0)
    {
      edges.blur = (this->PeakValue() - outside) / (slope * std::sqrt(2.0 * M_PI));
    }
  }

  const CorticalProfile &     m_Profile;
  const std::vector<double> & m_Values;
  const CorticalRules &       m_Rules;
  int                         m_Count;
  int                         m_Peak{ 0 };
};
} // namespace

CorticalEdges
FindCorticalEdges(const CorticalProfile & profile, const CorticalRules & rules)
{
  return EdgeFinder(profile, rules).Find();
}

double
ThicknessOfBlurredLayer(double width, double blur)
{
  if (!(blur > 0.0) || width > DistinctWidth * blur)
  {
    return width;
  }
  // Widths rise with the thickness: the place among them, in between linear.
  constexpr int     count = 161;
  constexpr double  step = (DistinctWidth - 1.0) / (count - 1);
  static const auto widths = [] {
    std::array<double, count> table;
    for (int k = 0; k < count; ++k)
    {
      table[static_cast<std::size_t>(k)] = BlurredWidth(1.0 + k * step);
    }
    return table;
  }();
  const double relative = width / blur;
  const auto   above = std::upper_bound(widths.begin(), widths.end(), relative);
  if (above == widths.begin())
  {
    return blur;
  }
  if (above == widths.end())
  {
    return width;
  }
  const double between = (relative - *(above - 1)) / (*above - *(above - 1));
  return (1.0 + (static_cast<double>(above - widths.begin()) - 1.0 + between) * step) * blur;
}
} // namespace bone
