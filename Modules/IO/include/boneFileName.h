/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFileName_h
#define boneFileName_h

#include <string>

namespace bone
{
/** Whether the path ends in the extension, which has its dot, in any case of its letters. */
bool
HasExtension(const std::string & path, const std::string & extension);

/** Throws IOError unless the path names a regular file that is not empty and can be opened. */
void
RequireReadableFile(const std::string & path);
} // namespace bone

#endif
