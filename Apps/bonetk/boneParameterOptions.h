/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneParameterOptions_h
#define boneParameterOptions_h

#include "boneParameters.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <initializer_list>
#include <string>
#include <vector>

namespace bone
{
/** \name Options from tables of parameters (\ref Parameters)
 * On the command line an angle is in degrees and a share in percent; inside they are radians and shares of 1.
 * \{ */

/** What a number of the command line is multiplied with to become the parameter. */
double
OptionFactor(const ParameterField & field);

/** "help, unit; default text", for a parameter whose default reads `text` (empty: it has none). */
std::string
OptionHelp(const ParameterField & field, const std::string & text);

/** Throws CLI::ValidationError: "--option: reason". */
[[noreturn]] void
RefuseOption(const ParameterField & field, const std::string & reason);

/** Whether `text`, all of it, is a decimal number. */
template <typename T>
bool
ParseNumber(const std::string & text, T & number)
{
  const char * end = text.data() + text.size();
  const auto   parsed = std::from_chars(text.data() + (text[0] == '+' ? 1 : 0), end, number);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

/** The number that `text` is, all of it, in decimal. Throws CLI::ValidationError where it is none, or out of range. */
template <typename T>
T
ParseOption(const ParameterField & field, const std::string & text)
{
  if constexpr (std::is_enum_v<T>)
  {
    try
    {
      return ParseChoice<T>(text);
    }
    catch (const std::invalid_argument & error)
    {
      RefuseOption(field, error.what());
    }
  }
  else
  {
    T number{};
    if (!ParseNumber(text, number))
    {
      RefuseOption(field, text + " is no " + (std::is_integral_v<T> ? "whole number" : "number"));
    }
    const double factor = OptionFactor(field);
    if (factor != 1.0)
    {
      number = static_cast<T>(number * factor);
    }
    if (!field.range.Contains(static_cast<double>(number)))
    {
      ParameterRange range = field.range;
      range.lower /= factor;
      range.upper /= factor;
      RefuseOption(field, text + " must be " + range.Describe());
    }
    return number;
  }
}

/** The default as the command line would have it. */
template <typename T>
std::string
OptionDefault(const ParameterField & field, const T & value)
{
  if constexpr (std::is_floating_point_v<T>)
  {
    return ParameterText(value / OptionFactor(field));
  }
  else
  {
    return ParameterText(value);
  }
}

/** "linear|log" */
template <typename TEnumeration>
std::string
JoinChoices()
{
  std::string text;
  for (const char * name : ParameterChoices<TEnumeration>::names)
  {
    text += (text.empty() ? "" : "|") + std::string(name);
  }
  return text;
}

template <typename T>
CLI::Option *
AddParameterOption(CLI::App * command, const ParameterField & field, T & value)
{
  const std::string name = std::string("--") + field.option;
  if constexpr (std::is_same_v<T, bool>)
  {
    // What is on by itself needs a way to turn it off.
    return value ? command->add_flag(name + ",!--no-" + field.option, value, std::string(field.help) + " (default)")
                 : command->add_flag(name, value, field.help);
  }
  else if constexpr (std::is_enum_v<T> || std::is_arithmetic_v<T>)
  {
    auto * option = command->add_option_function<std::string>(
      name,
      [field, &value](const std::string & text) { value = ParseOption<T>(field, text); },
      OptionHelp(field, OptionDefault(field, value)));
    if constexpr (std::is_enum_v<T>)
    {
      return option->type_name(JoinChoices<T>());
    }
    else
    {
      return option->type_name(std::is_integral_v<T> ? "INT" : "NUMBER");
    }
  }
  else
  {
    using Element = typename T::value_type;
    auto * option = command->add_option_function<std::vector<std::string>>(
      name,
      [field, &value](const std::vector<std::string> & texts) {
        T parsed;
        for (const std::string & text : texts)
        {
          parsed.push_back(ParseOption<Element>(field, text));
        }
        value = std::move(parsed);
      },
      OptionHelp(field, ParameterText(value)));
    return option->type_name(std::is_integral_v<Element> ? "INT" : "NUMBER");
  }
}

/** Adds an option for each parameter of `parameters` that has one, or for these `members` alone; their values are set
 * in `parameters`, whose values now are the defaults that the help shows. */
template <typename TParameters>
void
AddParameterOptions(CLI::App *                                command,
                    TParameters &                             parameters,
                    std::initializer_list<const char *> const members = {})
{
  TParameters::Visit(parameters, [&](const ParameterField & field, auto & value) {
    const bool named =
      std::any_of(members.begin(), members.end(), [&field](std::string name) { return name == field.member; });
    if (*field.option != '\0' && (named || members.size() == 0))
    {
      AddParameterOption(command, field, value);
    }
  });
}
/** \} */
} // namespace bone

#endif
