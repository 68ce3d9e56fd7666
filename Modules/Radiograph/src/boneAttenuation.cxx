/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAttenuation.h"

#include <algorithm>
#include <ostream>

namespace bone
{
std::ostream &
operator<<(std::ostream & os, HUToAttenuation conversion)
{
  static const char * const names[] = { "None", "WaterScaled", "Bilinear", "Table" };
  return os << names[static_cast<int>(conversion)];
}

std::ostream &
operator<<(std::ostream & os, const std::vector<AttenuationPoint> & table)
{
  for (const AttenuationPoint & point : table)
  {
    os << point.hu << ": " << point.attenuation << ' ';
  }
  return os;
}

LinearConversion
AttenuationCurve::Line() const
{
  return conversion == HUToAttenuation::None ? LinearConversion() : LinearConversion{ water / 1000.0, water };
}

double
AttenuationCurve::At(double value) const
{
  switch (conversion)
  {
    case HUToAttenuation::None:
      return value;
    case HUToAttenuation::WaterScaled:
      return std::max(0.0, water * (1 + value / 1000));
    case HUToAttenuation::Bilinear:
      return std::max(0.0, water + value * (value < 0 ? water / 1000 : boneSlope));
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
