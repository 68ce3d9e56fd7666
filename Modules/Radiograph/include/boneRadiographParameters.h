/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneRadiographParameters_h
#define boneRadiographParameters_h

#include "boneParameters.h"

namespace bone
{
/** How Hounsfield units become attenuation before a line integral is taken. */
enum class HUToAttenuation : int
{
  /** The density itself is integrated, in its units times mm; below 0 HU (fat, marrow, air) it counts negative. */
  None = 0,
  /** mu = mu_water (1 + HU / 1000), per mm; the integral has no unit. */
  WaterScaled = 1,
  /** Below 0 HU as WaterScaled, above along another line: bone absorbs more at low energies than its HU say. */
  Bilinear = 2,
  /** Linear between the points of a table, constant beyond them. */
  Table = 3
};

template <>
struct ParameterChoices<HUToAttenuation>
{
  static constexpr std::array<const char *, 4> names = { "none", "water", "bilinear", "table" };
};

/** Attenuation of water per mm at 60 keV, about the mean energy of a 120 kV beam (NIST XCOM: 0.2059 per cm). */
constexpr double WaterAttenuationAt60keV = 0.02059;

/** The line from water to cortical bone (ICRU-44, 1.92 g/cm^3: 0.06047 per mm at 60 keV, NIST XCOM) at 1,600 HU. */
constexpr double BoneSlopeAt60keV = (0.06047 - WaterAttenuationAt60keV) / 1600;

// clang-format off
/** The conversions that are a line. */
#define BONE_ATTENUATION_LINE_PARAMETERS(value, flag) \
  value(HUToAttenuation, huToAttenuation, HUToAttenuation, HUToAttenuation::None, ParameterRange::Any(), "", \
    "hu-to-attenuation", \
    "Turn HU into attenuation first: none, water (a line), bilinear (bone along a line of its own; CT only), table") \
  value(double, waterAttenuation, WaterAttenuation, WaterAttenuationAt60keV, ParameterRange::Positive(), "per mm", \
    "water-attenuation", "Attenuation of water")

#define BONE_RADIOGRAPH_PARAMETERS(value, flag) \
  BONE_ATTENUATION_LINE_PARAMETERS(value, flag) \
  value(double, boneSlope, BoneSlope, BoneSlopeAt60keV, ParameterRange::NotNegative(), "per mm and HU", "bone-slope", \
    "Rise of the attenuation above 0 HU with bilinear")
// clang-format on

/** Parameters of RadiographSource and AttenuationImageFilter. */
BONE_PARAMETER_STRUCT(RadiographParameters, BONE_RADIOGRAPH_PARAMETERS);
} // namespace bone

#endif
