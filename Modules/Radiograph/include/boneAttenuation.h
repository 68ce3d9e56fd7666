/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAttenuation_h
#define boneAttenuation_h

#include <iosfwd>
#include <vector>

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

std::ostream &
operator<<(std::ostream & os, HUToAttenuation conversion);

/** HU and attenuation per mm of one point of a table. */
struct AttenuationPoint
{
  double hu;
  double attenuation;
  bool
  operator==(const AttenuationPoint & other) const
  {
    return hu == other.hu && attenuation == other.attenuation;
  }
};

std::ostream &
operator<<(std::ostream & os, const std::vector<AttenuationPoint> & table);

/** Attenuation of water per mm at 60 keV, about the mean energy of a 120 kV beam (NIST XCOM: 0.2059 per cm). */
constexpr double WaterAttenuationAt60keV = 0.02059;

/** value -> scale * value + offset. */
struct LinearConversion
{
  double scale{ 1.0 };
  double offset{ 0.0 };
};

/** A conversion with its numbers. */
struct AttenuationCurve
{
  HUToAttenuation conversion{ HUToAttenuation::None };
  double          water{ WaterAttenuationAt60keV }; ///< per mm
  /** Bilinear: rise of the attenuation per HU above 0 HU, per mm. The default passes through water and cortical bone
   * (ICRU-44, 1.92 g/cm^3: 0.06047 per mm at 60 keV, NIST XCOM) at 1,600 HU. */
  double                        boneSlope{ (0.06047 - WaterAttenuationAt60keV) / 1600 };
  std::vector<AttenuationPoint> table; ///< Table: by rising HU

  /** For a voxel. Attenuation is not negative: what is below air counts as air. */
  double
  At(double value) const;

  /** The conversion, which must be None or WaterScaled, as one line. */
  LinearConversion
  Line() const;
};
} // namespace bone

#endif
