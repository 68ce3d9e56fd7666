/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProjectionKernel.h"

#ifdef BONE_PROJECTION_X86

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC            push_options
#pragma GCC            target("avx2,fma")
// Vectors are handed over within this file only.
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

#define BONE_PROJECTION_NAMESPACE avx2
#define BONE_PROJECTION_TILE_ROWS 1
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
const Kernels avx2Kernels = { avx2::Expand, avx2::AddBlocks, avx2::DeriveBlocks, avx2::AdjoinBlocks };
} // namespace projection
} // namespace bone

#endif
