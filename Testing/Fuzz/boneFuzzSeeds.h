/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFuzzSeeds_h
#define boneFuzzSeeds_h

#include <string>

namespace bone
{
/** Writes a small whole file of every format that BoneTK reads into a folder, made from phantoms. */
void
WriteFuzzSeeds(const std::string & folder);
} // namespace bone

#endif
