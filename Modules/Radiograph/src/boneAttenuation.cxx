/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAttenuation.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace bone
{
std::ostream &
operator<<(std::ostream & os, const std::vector<AttenuationPoint> & table)
{
  for (const AttenuationPoint & point : table)
  {
    os << point.hu << ": " << point.attenuation << ' ';
  }
  return os;
}

std::string
AttenuationCurve::FindObstacle() const
{
  const auto usable = [](const AttenuationPoint & p) { return std::isfinite(p.hu) && p.attenuation >= 0; };
  const auto falls = [](const AttenuationPoint & a, const AttenuationPoint & b) { return !(a.hu < b.hu); };
  if (huToAttenuation != HUToAttenuation::Table ||
      (!table.empty() && std::all_of(table.begin(), table.end(), usable) &&
       std::adjacent_find(table.begin(), table.end(), falls) == table.end()))
  {
    return {};
  }
  std::ostringstream text;
  text << "AttenuationTable (" << table << ") must hold points of rising HU with attenuations that are not negative.";
  return text.str();
}

double
AttenuationCurve::At(double value) const
{
  switch (huToAttenuation)
  {
    case HUToAttenuation::None:
      return value;
    case HUToAttenuation::WaterScaled:
      return std::max(0.0, waterAttenuation * (1 + value / 1000));
    case HUToAttenuation::Bilinear:
      return std::max(0.0, waterAttenuation + value * (value < 0 ? waterAttenuation / 1000 : boneSlope));
    case HUToAttenuation::Table:
      break;
  }
  const auto after = std::upper_bound(
    table.begin(), table.end(), value, [](double hu, const AttenuationPoint & point) { return hu < point.hu; });
  if (after == table.begin() || after == table.end())
  {
    return after == table.begin() ? table.front().attenuation : table.back().attenuation;
  }
  const AttenuationPoint & low = *(after - 1);
  return low.attenuation + (value - low.hu) / (after->hu - low.hu) * (after->attenuation - low.attenuation);
}
} // namespace bone
