/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCommandLine_h
#define boneCommandLine_h

#include "boneCommands.h"
#include "boneSession.h"

#include <string>
#include <vector>

namespace bone
{
/** \defgroup CommandLine The program bonetk as a library
 * \{ */
/** Runs what the words after `bonetk` say and returns the exit code: 0 done, 1 bad data, 2 bad usage. Errors are told
 * to the session and not thrown. The outputs appear together, or not at all where the work fails or is stopped. ITK's
 * number of threads is afterwards as it was. One at a time in a process. */
int
RunCommandLine(const std::vector<std::string> & words, Session & session);

/** Adds all commands with all their options. */
void
AddCommands(CLI::App & app, Action & action, Session & session);

/** What a program has to know of an option to offer it to its own users. */
struct OptionDescription
{
  std::string              name;  ///< of a value by its place that of its place, else the long name without dashes
  std::vector<std::string> names; ///< as they are typed: "-o", "--output"; a value by its place may have none
  bool                     positional{ false };
  bool                     required{ false };
  bool                     flag{ false }; ///< takes no value
  std::string              negative;      ///< long name that turns the flag off; empty: none
  std::string              type;          ///< "FLOAT", "INT", "TEXT", "x|y|z"
  int                      least{ 1 };    ///< number of values
  int                      most{ 1 };     ///< -1: any
  int                      each{ 0 }; ///< so many values a time the option is named, which may be often; 0: all at once
  bool                     output{ false };
  std::string              help; ///< with unit and default
};

struct CommandDescription
{
  std::string                    name; ///< "drr", "register rigid"
  std::string                    help;
  std::vector<OptionDescription> options; ///< those that need a value at their place first
};

/** Every command, in the order of the program's help. */
std::vector<CommandDescription>
DescribeCommands();

/** What the program's help says first. */
std::string
DescribeProgram();
/** \} */
} // namespace bone

#endif
