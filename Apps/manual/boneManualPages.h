/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneManualPages_h
#define boneManualPages_h

#include "boneCommandLine.h"

namespace bone
{
/** A file to write. */
struct TextFile
{
  std::string name;
  std::string text;
};

/** bonetk.1 and a page for each command, bonetk-build.1, bonetk-register-rigid.1, in the macros of man(7). */
std::vector<TextFile>
MakeManualPages(const std::vector<CommandDescription> & commands);
} // namespace bone

#endif
