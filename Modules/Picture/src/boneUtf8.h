/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneUtf8_h
#define boneUtf8_h

#include <string>

namespace bone
{
/** The text with a question mark for each byte that is no part of UTF-8, and blanks for control characters. */
std::string
ToValidUtf8(const std::string & text);
} // namespace bone

#endif
