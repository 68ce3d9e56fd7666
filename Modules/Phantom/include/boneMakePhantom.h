/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMakePhantom_h
#define boneMakePhantom_h

#include "bonePhantomModel.h"

#include <cstdint>
#include <string>
#include <vector>

namespace bone
{
/** Names that MakePhantom knows: "femur", "hemipelvis". */
const std::vector<std::string> &
PhantomNames();

/** The analytic phantom of that name; seed 0 is the mean subject. Throws itk::ExceptionObject that lists the names for
 * another name. */
PhantomModel::Pointer
MakePhantom(const std::string & name, std::uint64_t seed = 0);
} // namespace bone

#endif
