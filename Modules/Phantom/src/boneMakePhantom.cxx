/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMakePhantom.h"

#include "boneFemurPhantom.h"
#include "boneHemipelvisPhantom.h"

#include <itkMacro.h>

namespace bone
{
const std::vector<std::string> &
PhantomNames()
{
  static const std::vector<std::string> names{ "femur", "hemipelvis" };
  return names;
}

PhantomModel::Pointer
MakePhantom(const std::string & name, std::uint64_t seed)
{
  if (name == "femur")
  {
    return std::make_shared<const FemurPhantom>(seed);
  }
  if (name == "hemipelvis")
  {
    return std::make_shared<const HemipelvisPhantom>(seed);
  }
  std::string known;
  for (const std::string & one : PhantomNames())
  {
    known += (known.empty() ? "" : ", ") + one;
  }
  itkGenericExceptionMacro("There is no phantom named \"" << name << "\"; known are: " << known << ".");
}
} // namespace bone
