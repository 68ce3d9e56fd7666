/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneJson.h"

#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <algorithm>
#include <fstream>

namespace bone
{
using nlohmann::json;

namespace
{
/** Files that are read here have five levels; destroying a document goes as deep as it is nested. */
constexpr int DeepestNesting = 100;
} // namespace

json
ReadJsonFile(const std::string & path)
{
  RequireReadableFile(path);
  std::ifstream stream(path, std::ios::binary);
  try
  {
    return json::parse(stream, [&path](int depth, json::parse_event_t, json &) {
      if (depth > DeepestNesting)
      {
        throw IOError(path, Say("is nested more than ", DeepestNesting, " levels deep: it is no file of this kind"));
      }
      return true;
    });
  }
  catch (const json::exception & error)
  {
    const std::string text = error.what(); // "[json.exception...] what and where"
    const auto        bracket = text.find("] ");
    throw IOError(path, "is no JSON: " + (bracket == std::string::npos ? text : text.substr(bracket + 2)));
  }
}

const json &
Member(const json & object, const char * name)
{
  if (!object.is_object())
  {
    Refuse("has ", object.type_name(), " where an object with '", name, "' is needed");
  }
  const auto found = object.find(name);
  if (found == object.end())
  {
    Refuse("'", name, "' is missing");
  }
  return *found;
}

double
NumberMember(const json & object, const char * name)
{
  const json & value = Member(object, name);
  if (!value.is_number())
  {
    Refuse("'", name, "' must be a number");
  }
  return value.get<double>();
}

long long
WholeMember(const json & object, const char * name, long long lowest, long long highest)
{
  const json & value = Member(object, name);
  if (!value.is_number_integer() || value.get<long long>() < lowest || value.get<long long>() > highest)
  {
    Refuse("'", name, "' must be a whole number from ", lowest, " to ", highest);
  }
  return value.get<long long>();
}

std::string
TextMember(const json & object, const char * name)
{
  const json & value = Member(object, name);
  if (!value.is_string())
  {
    Refuse("'", name, "' must be a text");
  }
  return value.get<std::string>();
}

std::string
FileMember(const json & object, const char * name)
{
  const std::string file = TextMember(object, name);
  if (file.empty())
  {
    Refuse("'", name, "' must be the name of a file");
  }
  return file;
}

Eigen::VectorXd
NumbersMember(const json & object, const char * name, int count)
{
  const json & value = Member(object, name);
  if (!value.is_array() || value.size() != static_cast<std::size_t>(count) ||
      !std::all_of(value.begin(), value.end(), [](const json & entry) { return entry.is_number(); }))
  {
    Refuse("'", name, "' must be a list of ", count, " numbers");
  }
  Eigen::VectorXd numbers(count);
  for (int i = 0; i < count; ++i)
  {
    numbers[i] = value[i].get<double>();
  }
  return numbers;
}

void
RequireMembersAmong(const json & object, std::initializer_list<const char *> names)
{
  if (!object.is_object())
  {
    Refuse("is ", object.type_name(), " where an object is needed");
  }
  for (const auto & member : object.items())
  {
    if (std::find(names.begin(), names.end(), member.key()) == names.end())
    {
      std::string known;
      for (const char * name : names)
      {
        known += (known.empty() ? "" : ", ") + std::string(name);
      }
      Refuse("'", member.key(), "' is unknown; there are ", known);
    }
  }
}
} // namespace bone
