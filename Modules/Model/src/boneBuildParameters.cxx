/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildParameters.h"

#include "boneIOError.h"
#include "boneJson.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace
{
using Json = nlohmann::ordered_json;

template <typename T>
Json
JsonOf(const T & value)
{
  if constexpr (std::is_enum_v<T>)
  {
    return ParameterText(value);
  }
  else if constexpr (std::is_floating_point_v<T>)
  {
    return std::isfinite(value) ? Json(value) : Json(ParameterText(value));
  }
  else if constexpr (std::is_arithmetic_v<T>)
  {
    return value;
  }
  else
  {
    Json array = Json::array();
    for (const auto & element : value)
    {
      array.push_back(JsonOf(element));
    }
    return array;
  }
}

std::string
TextOf(const nlohmann::json & json)
{
  if (!json.is_string())
  {
    throw std::invalid_argument(json.dump() + " is no text.");
  }
  return json.get<std::string>();
}

template <typename T>
T
ValueOf(const nlohmann::json & json)
{
  if constexpr (std::is_enum_v<T>)
  {
    return ParseChoice<T>(TextOf(json));
  }
  else if constexpr (std::is_same_v<T, bool>)
  {
    if (!json.is_boolean())
    {
      throw std::invalid_argument(json.dump() + " is neither true nor false.");
    }
    return json.get<bool>();
  }
  else if constexpr (std::is_floating_point_v<T>)
  {
    if (json.is_string())
    {
      const std::string text = TextOf(json);
      if (text != "inf" && text != "-inf")
      {
        throw std::invalid_argument('"' + text + "\" is no number.");
      }
      return text == "inf" ? std::numeric_limits<T>::infinity() : -std::numeric_limits<T>::infinity();
    }
    if (!json.is_number())
    {
      throw std::invalid_argument(json.dump() + " is no number.");
    }
    return json.get<T>();
  }
  else if constexpr (std::is_arithmetic_v<T>)
  {
    const double value = json.is_number_integer() ? json.get<double>() : 0.0;
    if (!json.is_number_integer() || value > std::numeric_limits<int>::max() || value < std::numeric_limits<int>::min())
    {
      throw std::invalid_argument(json.dump() + " is no whole number that can be.");
    }
    return json.get<T>();
  }
  else
  {
    if (!json.is_array())
    {
      throw std::invalid_argument(json.dump() + " is no list.");
    }
    T values;
    for (const nlohmann::json & element : json)
    {
      values.push_back(ValueOf<typename T::value_type>(element));
    }
    return values;
  }
}

/** Sets the parameters of a stage from an object. Throws std::invalid_argument. */
template <typename TParameters>
void
ReadStage(const nlohmann::json & object, const std::string & stage, TParameters & parameters)
{
  for (const auto & item : object.items())
  {
    bool known = false;
    TParameters::Visit(parameters, [&](const ParameterField & field, auto & value) {
      if (item.key() != field.member)
      {
        return;
      }
      known = true;
      try
      {
        value = ValueOf<std::decay_t<decltype(value)>>(item.value());
        VerifyParameter(field, value);
      }
      catch (const std::exception & error)
      {
        throw std::invalid_argument(stage + '.' + field.member + ": " + error.what());
      }
    });
    if (!known)
    {
      throw std::invalid_argument(stage + '.' + item.key() + " is no parameter.");
    }
  }
}
} // namespace

std::string
ToJson(const BuildParameters & parameters)
{
  Json json;
  BuildParameters::Visit(parameters, [&json](const std::string & stage, const auto & of) {
    std::decay_t<decltype(of)>::Visit(
      of, [&](const ParameterField & field, const auto & value) { json[stage][field.member] = JsonOf(value); });
  });
  return json.dump(2);
}

void
ReadBuildParameters(const std::string & path, BuildParameters & parameters, BuildFiles & files)
{
  try
  {
    const nlohmann::json   json = ReadJsonFile(path);
    const nlohmann::json & given = json.contains("parameters") ? json.at("parameters") : json;
    if (!given.is_object())
    {
      throw std::invalid_argument("it holds no parameters: it must be a build's report.json or have its form.");
    }
    for (const auto & item : given.items())
    {
      bool known = false;
      BuildParameters::Visit(parameters, [&](const std::string & stage, auto & of) {
        if (item.key() == stage)
        {
          known = true;
          ReadStage(item.value(), stage, of);
        }
      });
      if (!known)
      {
        throw std::invalid_argument(item.key() + " is no stage of a build.");
      }
    }
    if (json.contains("input"))
    {
      const auto text = [&input = json.at("input")](const char * name) {
        return input.contains(name) ? TextOf(input.at(name)) : std::string();
      };
      files = { text("image"),     text("series"),          text("labels"),    text("labelNames"),
                text("labelName"), text("initialContours"), text("structure"), text("atlas") };
    }
  }
  catch (const IOError &)
  {
    throw;
  }
  catch (const std::exception & error)
  {
    throw IOError(path, error.what());
  }
}
} // namespace bone
