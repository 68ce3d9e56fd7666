/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectionKernel.h"

#ifdef BONE_PROJECTION_X86

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,avx512f,avx512vl,avx512dq"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,avx512f,avx512vl,avx512dq,prefer-vector-width=256")
#endif

#define BONE_PROJECTION_NAMESPACE avx512
#define BONE_PROJECTION_TILE_ROWS 2
#include "boneBlockKernel.hxx"

#include "boneAdjointKernel.hxx"
#include "boneDerivativeKernel.hxx"

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

namespace bone
{
namespace projection
{
const Kernels avx512Kernels = { avx512::Expand, avx512::AddBlocks, avx512::DeriveBlocks, avx512::AdjoinBlocks };
} // namespace projection
} // namespace bone

#endif
