/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAttenuation_h
#define boneAttenuation_h

#include <iosfwd>

namespace bone
{
/** How Hounsfield units become attenuation before a line integral is taken. */
enum class HUToAttenuation : int
{
  /** The density itself is integrated, in its units times mm; below 0 HU (fat, marrow, air) it counts negative. */
  None = 0,
  /** mu = mu_water (1 + HU / 1000), per mm; the integral has no unit. */
  WaterScaled = 1
};

std::ostream &
operator<<(std::ostream & os, HUToAttenuation conversion);

/** Attenuation of water per mm at 60 keV, about the mean energy of a 120 kV beam (NIST XCOM: 0.2059 per cm). */
constexpr double WaterAttenuationAt60keV = 0.02059;

/** value -> scale * value + offset. */
struct LinearConversion
{
  double scale{ 1.0 };
  double offset{ 0.0 };
};

/** The conversion in numbers. */
LinearConversion
MakeConversion(HUToAttenuation conversion, double waterAttenuation);
} // namespace bone

#endif
