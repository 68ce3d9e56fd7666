/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFuzzChild_h
#define boneFuzzChild_h

#include <functional>
#include <string>
#include <vector>

namespace bone
{
/** What a child process may take: ten seconds of a processor and 4 GB. */
constexpr unsigned int LongestFuzzSeconds = 10;
constexpr int          LargestFuzzGigabytes = 4;

/** The exit code by which the sanitizers tell that they found something; none of BoneTK's. */
constexpr int SanitizerExitCode = 99;

/** How a child process ended. */
struct ChildEnd
{
  int         code{ 0 }; ///< its exit code, where nothing is wrong
  std::string wrong;     ///< a signal, too long, too much memory, a sanitizer's report; empty: nothing
};

/** Runs `action` in a process of its own, whose standard error goes to the file `log`. */
ChildEnd
RunInChild(const std::function<int()> & action, const std::string & log);

/** The same for a program with its arguments, in `folder`. */
ChildEnd
RunProgram(const std::vector<std::string> & command, const std::string & folder, const std::string & log);

/** Why a message is no line for a person: empty, broken into lines, too long, with signs that cannot be printed, or
 * with names from the code of BoneTK or the libraries under it. Empty where it is one. */
std::string
FindMessageFault(const std::string & message);

/** The bytes of a file, and a file made of bytes. */
std::string
ReadBytes(const std::string & path);
void
WriteBytes(const std::string & path, const std::string & bytes);
} // namespace bone

#endif
