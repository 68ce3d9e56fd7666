/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOutlineContrast.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace bone
{
namespace
{
constexpr std::size_t LeastPlaces = 100;    // fewer do not tell
constexpr double      LeastBrighter = 0.65; // share of a bone's outline
constexpr float       MostOutside = 400.0F; // HU, median: more than soft tissue, beside other bones too
constexpr float       LeastRim = 300.0F;    // HU, of the brightest hundredth of a bone's rim

float
Quantile(std::vector<float> values, double share)
{
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}
} // namespace

double
OutlineContrast::ReachOutside(double pixel)
{
  return std::max(3.0, 2.0 * pixel);
}

void
OutlineContrast::Add(double inside, double outside, double weight)
{
  if (std::isfinite(inside) && std::isfinite(outside))
  {
    m_Brighter += inside > outside ? weight : 0.0;
    m_Weight += weight;
    m_Inside.push_back(static_cast<float>(inside));
    m_Outside.push_back(static_cast<float>(outside));
  }
}

void
OutlineContrast::Add(const OutlineContrast & other)
{
  m_Brighter += other.m_Brighter;
  m_Weight += other.m_Weight;
  m_Inside.insert(m_Inside.end(), other.m_Inside.begin(), other.m_Inside.end());
  m_Outside.insert(m_Outside.end(), other.m_Outside.begin(), other.m_Outside.end());
}

double
OutlineContrast::GetBrighterShare() const
{
  return m_Inside.size() >= LeastPlaces && m_Weight > 0.0 ? m_Brighter / m_Weight : 1.0;
}

std::string
OutlineContrast::FindMismatch(const std::string & outline) const
{
  const double share = this->GetBrighterShare();
  if (share >= LeastBrighter)
  {
    return {};
  }
  std::ostringstream text;
  text << "Only " << std::lround(100.0 * share)
       << " % of the bone's outline is brighter on the inside than a few millimetres outside: do CT and " << outline
       << " belong together? One of them may be mirrored, shifted or another patient's.";
  return text.str();
}

std::string
OutlineContrast::FindForeignUnits() const
{
  std::ostringstream text;
  if (m_Inside.size() < LeastPlaces)
  {
    return {};
  }
  const float beside = Quantile(m_Outside, 0.5), rim = Quantile(m_Inside, 0.99);
  if (beside > MostOutside)
  {
    text << "Beside the bone the CT has " << std::lround(beside)
         << " (median), where soft tissue has -100 to 100 HU: are its values HU? An offset such as 1024 is to be "
            "subtracted.";
  }
  else if (rim < LeastRim)
  {
    text << "At the bone's rim the CT reaches " << std::lround(rim)
         << " (99 % of it), where bone has 500 HU and more: are its values HU, and not a display window's?";
  }
  return text.str();
}
} // namespace bone
