/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographValues_h
#define boneRadiographValues_h

#include "boneParameters.h"

namespace bone
{
/** What the pixels of a radiograph are. */
enum class RadiographValues : int
{
  /** Line integrals of attenuation, without unit. */
  Integral = 0,
  /** Proportional to the photons at the detector. */
  Intensity = 1,
  /** Made to be looked at: an unknown rising or falling function of the attenuation. */
  Display = 2
};

template <>
struct ParameterChoices<RadiographValues>
{
  static constexpr std::array<const char *, 3> names = { "integral", "intensity", "display" };
};
} // namespace bone

#endif
