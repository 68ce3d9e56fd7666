/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectionKernel.h"

#ifdef BONE_PROJECTION_X86

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma")
#endif

#define BONE_PROJECTION_NAMESPACE avx2
#include "boneProjectionKernel.hxx"

namespace bone
{
namespace projection
{
void
AddCellsAvx2(CellGroup & group, const Band & band)
{
  avx2::AddCells(group, band);
}
} // namespace projection
} // namespace bone

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif
