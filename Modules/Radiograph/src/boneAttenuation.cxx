/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAttenuation.h"

#include <ostream>

namespace bone
{
std::ostream &
operator<<(std::ostream & os, HUToAttenuation conversion)
{
  return os << (conversion == HUToAttenuation::None ? "None" : "WaterScaled");
}

LinearConversion
MakeConversion(HUToAttenuation conversion, double waterAttenuation)
{
  return conversion == HUToAttenuation::None ? LinearConversion()
                                             : LinearConversion{ waterAttenuation / 1000.0, waterAttenuation };
}
} // namespace bone
