/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectionKernel.h"

#if !defined(__clang__)
// Vectors are handed over within this file only.
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

#define BONE_PROJECTION_NAMESPACE portable
#include "boneProjectionKernel.hxx"

namespace bone
{
namespace projection
{
void
AddCellsPortable(CellGroup & group, const Band & band)
{
  portable::AddCells(group, band);
}

AddCellsFunction
SelectAddCells()
{
#ifdef BONE_PROJECTION_X86
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("fma"))
  {
    return AddCellsAvx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
  {
    return AddCellsAvx2;
  }
#endif
  return AddCellsPortable;
}
} // namespace projection
} // namespace bone
