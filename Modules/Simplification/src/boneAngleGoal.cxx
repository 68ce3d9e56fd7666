/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAngleGoal.h"

#include "boneTetraFlips.h"

#include <cmath>

namespace bone
{
std::vector<IdType>
AngleFloors::FindBelow(const TetraComplex & complex) const
{
  std::vector<IdType> below;
  for (IdType t = 0; t < complex.Size(); ++t)
  {
    if (complex.IsAlive(t) && CellCosine(complex, t) > std::cos(this->Of(complex.Region(t))))
    {
      below.push_back(t);
    }
  }
  return below;
}
} // namespace bone
