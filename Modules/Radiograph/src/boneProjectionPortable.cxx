/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectionKernel.h"

#define BONE_PROJECTION_NAMESPACE portable
#include "boneProjectionKernel.hxx"

namespace bone
{
namespace projection
{
void
AddCellPortable(const Cell & cell, const Band & band)
{
  portable::AddCell(cell, band);
}

AddCellFunction
SelectAddCell()
{
#ifdef BONE_PROJECTION_AVX2
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
  {
    return AddCellAvx2;
  }
#endif
  return AddCellPortable;
}
} // namespace projection
} // namespace bone
