/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOptions.h"

#include "boneParameterOptions.h"

#include "boneAtomicFile.h"
#include "boneFileName.h"
#include "boneIOError.h"
#include "boneParameters.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace bone
{
namespace
{
template <typename TPredicate>
CLI::Validator
NumberWhere(TPredicate predicate, const std::string & description)
{
  return CLI::Validator(
    [predicate, description](std::string & text) {
      double value = std::nan("");
      if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value) || !predicate(value))
      {
        return text + " is not " + description;
      }
      return std::string();
    },
    std::string());
}

/** Zeros before a whole number, by which CLI11 would take it for octal, are taken away. A word is another's to judge:
 * that of a choice. */
std::string
ToDecimal(std::string & text)
{
  static const std::regex whole("([+-]?)0*([0-9]+)");
  if (!std::regex_match(text, whole))
  {
    return !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0 ? "" : text + " is no whole number";
  }
  text = std::regex_replace(text, whole, "$1$2");
  return "";
}

std::string
CheckDecimal(std::string & text)
{
  static const std::regex number("[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)?");
  return std::regex_match(text, number) ? "" : text + " is no number";
}
} // namespace

void
ReadDecimalNumbers(CLI::App & app)
{
  for (CLI::App * command : app.get_subcommands([](CLI::App *) { return true; }))
  {
    ReadDecimalNumbers(*command);
    for (CLI::Option * option : command->get_options())
    {
      const std::string type = option->get_type_name();
      if (type == "INT" || type == "UINT")
      {
        option->transform(CLI::Validator(ToDecimal, ""));
      }
      else if (type == "FLOAT")
      {
        option->transform(CLI::Validator(CheckDecimal, ""));
      }
    }
  }
}

bool
IsOutput(const CLI::Option & option)
{
  static const std::regex output("output|write-.*|save-.*|report|registered");
  const auto &            names = option.get_lnames();
  return std::any_of(
    names.begin(), names.end(), [](const std::string & name) { return std::regex_match(name, output); });
}

std::vector<std::string>
FindInputs(const CLI::App & command)
{
  std::vector<std::string> files;
  for (const CLI::Option * option : command.get_options())
  {
    const bool passed = IsOutput(*option) || option->check_lname("status");
    for (const std::string & text : passed ? std::vector<std::string>() : option->results())
    {
      std::error_code error;
      if (std::filesystem::exists(text, error))
      {
        files.push_back(text);
      }
    }
  }
  return files;
}

std::vector<std::string>
FindOutputs(const CLI::App & command)
{
  std::vector<std::string> outputs;
  for (const CLI::Option * option : command.get_options())
  {
    const auto results = IsOutput(*option) ? option->results() : std::vector<std::string>();
    outputs.insert(outputs.end(), results.begin(), results.end());
  }
  return outputs;
}

void
VerifyStatusFile(const std::string & path, const std::vector<std::string> & outputs)
{
  if (path.empty())
  {
    return;
  }
  const auto absolute = [](const std::filesystem::path & file) {
    std::error_code error;
    const auto      resolved = std::filesystem::weakly_canonical(std::filesystem::absolute(file), error);
    return error ? std::filesystem::absolute(file).lexically_normal() : resolved;
  };
  const std::string file = absolute(path).string();
  for (const std::string & output : outputs)
  {
    if (output.empty())
    {
      continue;
    }
    const std::filesystem::path whole = absolute(output);
    const std::string           name = whole.filename().string();
    const std::string           stem = (whole.parent_path() / name.substr(0, name.find('.', 1))).string();
    const bool begins = file.compare(0, stem.size(), stem) == 0 && std::strchr("/._", file[stem.size()]) != nullptr;
    if (file == whole || (begins && !HasExtension(file, ".jsonl")))
    {
      throw UsageError("the status file " + path + " may take the name of an output of " + output +
                       ": give it another, which ends in .jsonl");
    }
  }
}

CLI::Validator
Positive()
{
  return NumberWhere([](double x) { return x > 0.0; }, "a number above 0");
}

CLI::Validator
NotNegative()
{
  return NumberWhere([](double x) { return x >= 0.0; }, "a number of at least 0");
}

CLI::Validator
Between(double lower, double upper)
{
  std::ostringstream text;
  text << "a number from " << lower << " to " << upper;
  return NumberWhere([lower, upper](double x) { return x >= lower && x <= upper; }, text.str());
}

CLI::Validator
Length()
{
  return Between(ParameterRange::Length().lower, ParameterRange::Length().upper);
}

void
AddAxisOption(CLI::App * command, unsigned int & axis)
{
  const std::map<std::string, unsigned int> axes = { { "x", 0 }, { "y", 1 }, { "z", 2 } };
  command->add_option("--axis", axis, "Image axis that the slices are stacked along: x, y or z (default)")
    ->transform(CLI::Transformer(axes, CLI::ignore_case).description(""))
    ->check(CLI::IsMember({ 0U, 1U, 2U }).description(""))
    ->type_name("x|y|z");
}

void
AddStorageOptions(CLI::App * command, MeshStorageParameters & storage)
{
  AddParameterOptions(command, storage);
  command->get_option("--compact-error")->needs("--compact");
}

const std::vector<std::string> &
ImageExtensions()
{
  static const std::vector<std::string> extensions{
    ".nii.gz", ".nii", ".mha", ".mhd", ".nrrd", ".nhdr", ".hdr", ".img"
  };
  return extensions;
}

void
VerifyOutputs(const std::vector<OutputFile> & files)
{
  std::set<std::string> names;
  for (const OutputFile & file : files)
  {
    if (file.path.empty())
    {
      continue;
    }
    std::string list;
    bool        known = file.extensions.empty();
    for (const std::string & extension : file.extensions)
    {
      known = known || HasExtension(file.path, extension);
      list += (list.empty() ? "" : ", ") + extension;
    }
    if (!known)
    {
      throw UsageError("the output " + file.path + " must end in " + list);
    }
    try
    {
      const AtomicFile probe(file.path); // which makes a file beside it, and removes it
    }
    catch (const IOError & error)
    {
      throw UsageError(ErrorLine(error));
    }
    if (!names.insert(std::filesystem::absolute(file.path).lexically_normal().string()).second)
    {
      throw UsageError(file.path + " is the name of two outputs: give each a name of its own");
    }
  }
}
} // namespace bone
