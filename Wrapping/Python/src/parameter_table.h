/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef parameter_table_h
#define parameter_table_h

#include "failure.h"
#include "objects.h"

#include "boneParameters.h"

#include <pybind11/pybind11.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace bone::python
{
namespace py = pybind11;

/** \defgroup ParameterTable Parameters of a stage as values of Python, by their table
 * Enumerations are their names, vectors lists. Errors of a value are UsageFailure, with the line of VerifyParameter.
 * \{ */

/** A number of Python. Throws UsageFailure where it is none, or beyond [lower, upper]. */
double
ToReal(const py::handle & object, const ParameterField & field);
std::int64_t
ToWhole(const py::handle & object, const ParameterField & field, std::int64_t lower, std::int64_t upper);
std::uint64_t
ToWhole(const py::handle & object, const ParameterField & field);
bool
ToFlag(const py::handle & object, const ParameterField & field);
std::string
ToName(const py::handle & object, const ParameterField & field);

/** What help() says: help, unit, range, default. */
std::string
DescribeParameter(const ParameterField & field, const std::string & initial, const std::string & choices, bool number);

template <typename T>
struct IsVector : std::false_type
{
};
template <typename T>
struct IsVector<std::vector<T>> : std::true_type
{
};

template <typename T>
py::object
FromParameter(const T & value)
{
  if constexpr (std::is_enum_v<T>)
  {
    return py::str(ParameterText(value));
  }
  else if constexpr (IsVector<T>::value)
  {
    py::list list;
    for (const auto & element : value)
    {
      list.append(FromParameter(element));
    }
    return std::move(list);
  }
  else
  {
    return py::cast(value);
  }
}

template <typename T>
T
ToParameter(const py::handle & object, const ParameterField & field)
{
  if constexpr (std::is_same_v<T, bool>)
  {
    return ToFlag(object, field);
  }
  else if constexpr (std::is_enum_v<T>)
  {
    try
    {
      return ParseChoice<T>(ToName(object, field));
    }
    catch (const std::invalid_argument & error)
    {
      throw UsageFailure(std::string(field.name) + ' ' + error.what());
    }
  }
  else if constexpr (IsVector<T>::value)
  {
    T value;
    for (const auto & element : py::reinterpret_borrow<py::object>(object))
    {
      value.push_back(ToParameter<typename T::value_type>(element, field));
    }
    return value;
  }
  else if constexpr (std::is_floating_point_v<T>)
  {
    return static_cast<T>(ToReal(object, field));
  }
  else if constexpr (sizeof(T) == 8 && std::is_unsigned_v<T>)
  {
    return static_cast<T>(ToWhole(object, field));
  }
  else
  {
    return static_cast<T>(ToWhole(object, field, std::numeric_limits<T>::min(), std::numeric_limits<T>::max()));
  }
}

/** The parameter's names for its values, apart by commas; empty for others. */
template <typename T>
std::string
ChoicesOf(const T &)
{
  std::string list;
  if constexpr (std::is_enum_v<T>)
  {
    for (const char * name : ParameterChoices<T>::names)
    {
      list += (list.empty() ? "" : ", ") + std::string(name);
    }
  }
  return list;
}

/** How type stubs name the parameter's type (see generate_stubs.py). */
template <typename T>
std::string
AnnotationOf()
{
  if constexpr (std::is_enum_v<T>)
  {
    std::string names;
    for (const char * name : ParameterChoices<T>::names)
    {
      names += (names.empty() ? "\"" : ", \"") + std::string(name) + '"';
    }
    return "Literal[" + names + ']';
  }
  else if constexpr (IsVector<T>::value)
  {
    return "_List[" + AnnotationOf<typename T::value_type>() + ']';
  }
  else
  {
    return std::is_same_v<T, bool> ? "bool" : std::is_integral_v<T> ? "int" : "float";
  }
}

/** A parameter of a table: its name in Python, what help() says, and its type. */
struct ParameterEntry
{
  std::string name;
  std::string help;
  std::string annotation;
};
template <typename TStruct>
std::vector<ParameterEntry>
ListParameters()
{
  std::vector<ParameterEntry> entries;
  const TStruct               initial;
  TStruct::Visit(initial, [&entries](const ParameterField & field, const auto & value) {
    using T = std::decay_t<decltype(value)>;
    constexpr bool number = !std::is_enum_v<T> && !std::is_same_v<T, bool>;
    entries.push_back({ SnakeCase(field.member),
                        DescribeParameter(field, ParameterText(value), ChoicesOf(value), number),
                        AnnotationOf<T>() });
  });
  return entries;
}

template <typename TStruct>
py::object
GetParameter(const TStruct & parameters, std::size_t index)
{
  py::object  result;
  std::size_t i = 0;
  TStruct::Visit(parameters, [&](const ParameterField &, const auto & value) {
    if (i++ == index)
    {
      result = FromParameter(value);
    }
  });
  return result;
}

/** Throws UsageFailure for a value of another type or out of range. */
template <typename TStruct>
void
SetParameter(TStruct & parameters, std::size_t index, const py::handle & object)
{
  std::size_t i = 0;
  try
  {
    TStruct::Visit(parameters, [&](const ParameterField & field, auto & value) {
      if (i++ == index)
      {
        auto given = ToParameter<std::decay_t<decltype(value)>>(object, field);
        VerifyParameter(field, given);
        value = std::move(given);
      }
    });
  }
  catch (const std::invalid_argument & error)
  {
    throw UsageFailure(error.what());
  }
}

/** Sets by name; throws UsageFailure for a name that is none of the table's. Says whether the table has it. */
template <typename TStruct>
bool
SetParameterByName(TStruct & parameters, const std::string & name, const py::handle & object)
{
  const auto entries = ListParameters<TStruct>();
  for (std::size_t i = 0; i < entries.size(); ++i)
  {
    if (entries[i].name == name)
    {
      SetParameter(parameters, i, object);
      return true;
    }
  }
  return false;
}
/** The parameters with those that keywords name. Throws UsageFailure for one that `what` does not have. */
template <typename TStruct>
TStruct
ReadParameters(const py::kwargs & keywords, const char * what)
{
  TStruct parameters;
  for (const auto & item : keywords)
  {
    const auto name = item.first.cast<std::string>();
    if (!SetParameterByName(parameters, name, item.second))
    {
      throw UsageFailure(std::string(what) + " has no parameter \"" + name + '"');
    }
  }
  return parameters;
}
/** \} */
} // namespace bone::python

#endif
