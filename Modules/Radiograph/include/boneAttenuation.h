/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAttenuation_h
#define boneAttenuation_h

#include "boneRadiographParameters.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace bone
{
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

/** A conversion of HU with its numbers. */
struct AttenuationCurve : RadiographParameters
{
  std::vector<AttenuationPoint> table; ///< HUToAttenuation::Table: by rising HU

  /** For a voxel. Attenuation is not negative: what is below air counts as air. */
  double
  At(double value) const;

  /** Why the table cannot be used, where the conversion needs it; empty where it can. */
  std::string
  FindObstacle() const;

  friend bool
  operator==(const AttenuationCurve & a, const AttenuationCurve & b)
  {
    return static_cast<const RadiographParameters &>(a) == static_cast<const RadiographParameters &>(b) &&
           a.table == b.table;
  }
};
} // namespace bone

#endif
