/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectionKernel.h"

#ifdef BONE_PROJECTION_X86

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,avx512f,avx512vl,avx512dq,prefer-vector-width=256"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,avx512f,avx512vl,avx512dq,prefer-vector-width=256")
#endif

#define BONE_PROJECTION_NAMESPACE avx512
#include "boneProjectionKernel.hxx"

namespace bone
{
namespace projection
{
void
AddCellsAvx512(CellGroup & group, const Band & band)
{
  avx512::AddCells(group, band);
}
} // namespace projection
} // namespace bone

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif
