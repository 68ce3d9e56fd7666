/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFuzzCommands_h
#define boneFuzzCommands_h

#include "boneFuzzChild.h"

namespace bone
{
/** Runs a command line of bonetk, its words apart by blanks, in `folder`, which has an empty folder out/ for what it
 * writes. An error has to hold one of `names`; standard error goes to the file `log`. Beside how the process
 * ended, wrong is: another exit code than 0, 1 and 2; an error that is not exactly one line, which begins with
 * "bonetk COMMAND: ", is for a person and holds a name; any line on standard error else that is no warning; a file
 * left behind by a command that failed, or a hidden one by any. What a command wrote is removed. */
ChildEnd
RunCommand(const std::string &              program,
           const std::string &              line,
           const std::vector<std::string> & names,
           const std::string &              folder,
           const std::string &              log);
} // namespace bone

#endif
