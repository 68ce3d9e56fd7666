/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAlignmentKind_h
#define boneAlignmentKind_h

#include "boneParameters.h"

namespace bone
{
/** Which transforms an alignment may use. Numbers grow with freedom. */
enum class AlignmentKind : int
{
  None = 0,
  Rigid = 1,
  Similarity = 2, ///< and a size
  Affine = 3
};

template <>
struct ParameterChoices<AlignmentKind>
{
  static constexpr std::array<const char *, 4> names = { "none", "rigid", "similarity", "affine" };
};
} // namespace bone

#endif
