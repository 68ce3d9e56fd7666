/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneParameterOptions.h"

namespace bone
{
double
OptionFactor(const ParameterField & field)
{
  const std::string unit = field.unit;
  return unit == "rad" ? 0.017453292519943295 : unit == "share" ? 0.01 : 1.0;
}

std::string
OptionHelp(const ParameterField & field, const std::string & text)
{
  const std::string unit = field.unit;
  const std::string shown = unit == "rad" ? "degrees" : unit == "share" ? "%" : unit;
  return field.help + (shown.empty() ? "" : ", in " + shown) + (text.empty() ? "" : "; default " + text);
}

void
RefuseOption(const ParameterField & field, const std::string & reason)
{
  throw CLI::ValidationError(std::string("--") + field.option, reason);
}
} // namespace bone
