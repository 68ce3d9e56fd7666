/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneParameters.h"

namespace bone
{
std::string
ParameterRange::Describe() const
{
  std::ostringstream text;
  const bool         below = std::isfinite(upper);
  const bool         above = std::isfinite(lower);
  if (least > 0.0)
  {
    text << "0, or " << least << " to " << upper;
  }
  else if (above && below)
  {
    text << (open ? "above " : "") << lower << (open ? " and at most " : " to ") << upper;
  }
  else if (above)
  {
    text << (open ? "above " : "") << lower << (open ? "" : " or more");
  }
  else if (below)
  {
    text << "at most " << upper;
  }
  else
  {
    return infinite ? "a number" : "a finite number";
  }
  return text.str() + (infinite || below ? "" : " and finite");
}
} // namespace bone
