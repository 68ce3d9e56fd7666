/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCompletions_h
#define boneCompletions_h

#include "boneCommandLine.h"

namespace bone
{
/** \name What a shell reads to complete commands, options and their values
 * \{ */
std::string
MakeBashCompletion(const std::vector<CommandDescription> & commands);
std::string
MakeZshCompletion(const std::vector<CommandDescription> & commands);
std::string
MakeFishCompletion(const std::vector<CommandDescription> & commands);
/** \} */
} // namespace bone

#endif
