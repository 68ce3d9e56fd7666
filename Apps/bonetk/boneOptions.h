/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneOptions_h
#define boneOptions_h

#include "boneMeshStorageParameters.h"
#include "boneSession.h"

#include <CLI/CLI.hpp>

#include <string>

namespace bone
{
/** \name Validators for numbers; NaN and infinity are refused.
 * \{ */
CLI::Validator
Positive();
CLI::Validator
NotNegative();
/** mm; see ParameterRange::Length */
CLI::Validator
Length();
/** lower <= x <= upper */
CLI::Validator
Between(double lower, double upper);
/** \} */

/** Numbers of every option of the program's commands are decimal and all of their text: 010 is ten, 0x8 none. To be
 * called when all options are there. */
void
ReadDecimalNumbers(CLI::App & app);

/** Whether an option says where to write: a file, a folder, or the beginning of names. */
bool
IsOutput(const CLI::Option & option);

/** The files and folders that a parsed command reads: what its options name that is there, but for those that say where
 * to write. */
std::vector<std::string>
FindInputs(const CLI::App & command);

/** What a parsed command's options say to write: files, folders and beginnings of names. */
std::vector<std::string>
FindOutputs(const CLI::App & command);

/** Adds --axis x|y|z, the image axis that slices are stacked along, as 0, 1, 2. */
void
AddAxisOption(CLI::App * command, unsigned int & axis);

/** Adds --compact and --compact-error, which needs it. */
void
AddStorageOptions(CLI::App * command, MeshStorageParameters & storage);

/** Extensions of volumes and radiographs that can be written. */
const std::vector<std::string> &
ImageExtensions();

/** A file to write, or none where the path is empty. */
struct OutputFile
{
  std::string              path;
  std::vector<std::string> extensions; ///< of which it must have one; none: any
};

/** Throws UsageError where the status file (empty: there is none) has the name of one of a command's outputs
 * (FindOutputs), or may have that of a file in the folder, or with the beginning, that an output is. One that ends in
 * .jsonl has not: no output does. */
void
VerifyStatusFile(const std::string & path, const std::vector<std::string> & outputs);

/** Whether all these files can be written, which is to be found out before the work. Throws UsageError where one has
 * another extension, cannot be written, or has the name of another. */
void
VerifyOutputs(const std::vector<OutputFile> & files);
} // namespace bone

#endif
