/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneDensityQuantityChoices_h
#define boneDensityQuantityChoices_h

#include "boneParameters.h"
#include "boneTypes.h"

namespace bone
{
/** The quantities' names on the command line; ParseChoice<DensityQuantity> reads them. */
template <>
struct ParameterChoices<DensityQuantity>
{
  static constexpr std::array<const char *, 6> names = { "unknown", "hu", "k2hpo4", "ha", "ash", "apparent" };
};
} // namespace bone

#endif
