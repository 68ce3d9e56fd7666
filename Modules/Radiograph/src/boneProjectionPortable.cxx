/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectionKernel.h"

#if !defined(__clang__)
// Vectors are handed over within this file only.
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

#define BONE_PROJECTION_NAMESPACE portable
#define BONE_PROJECTION_TILE_ROWS 1
#include "boneBlockKernel.hxx"

#include "boneAdjointKernel.hxx"
#include "boneDerivativeKernel.hxx"

namespace bone
{
namespace projection
{
const Kernels portableKernels = { portable::Expand,
                                  portable::AddBlocks,
                                  portable::DeriveBlocks,
                                  portable::AdjoinBlocks };

const Kernels &
SelectKernels(bool portable)
{
#ifdef BONE_PROJECTION_X86
  if (!portable && __builtin_cpu_supports("fma"))
  {
    if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
    {
      return avx512Kernels;
    }
    if (__builtin_cpu_supports("avx2"))
    {
      return avx2Kernels;
    }
  }
#endif
  static_cast<void>(portable);
  return portableKernels;
}
} // namespace projection
} // namespace bone
