/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneProvenance_h
#define boneProvenance_h

#include "boneParameters.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace bone
{
/** \defgroup Provenance Where a result comes from
 * \{ */

/** A file, or the files of a folder in the order of their names. */
struct InputFile
{
  std::string   path;
  std::uint64_t bytes{ 0 };
  std::string   md5; ///< as md5sum has it; of a folder, that of its files one after the other
};

/** Size and checksum. Throws IOError where a file cannot be read. */
InputFile
DescribeInput(const std::string & path);

/** A parameter as it was used. */
struct ParameterValue
{
  std::string stage;
  std::string name; ///< of the option on the command line, or of the member
  std::string value;
  std::string unit;
  std::string help;
};

/** The computer: processor, number of processors, memory, operating system. One line. */
std::string
DescribeMachine();

/** The time now as "2026-03-01 14:05 UTC". */
std::string
TimeNow();

/** All that is to be known to do a job again. */
struct Provenance
{
  std::string                                 version; ///< "bonetk 0.1.0"
  std::string                                 command; ///< as it was called
  std::vector<InputFile>                      inputs;
  std::vector<ParameterValue>                 parameters;
  std::string                                 machine;
  std::string                                 time;
  std::vector<std::pair<std::string, double>> seconds; ///< by step
};

/** Adds a stage's parameters (\ref Parameters) with their units. */
template <typename TParameters>
void
AddParameters(const std::string & stage, const TParameters & parameters, std::vector<ParameterValue> & list)
{
  TParameters::Visit(parameters, [&](const ParameterField & field, const auto & value) {
    list.push_back(
      { stage, *field.option != '\0' ? field.option : field.member, ParameterText(value), field.unit, field.help });
  });
}
/** \} */
} // namespace bone

#endif
