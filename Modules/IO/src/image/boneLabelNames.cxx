/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelIO.h"

#include "boneGzFile.h"
#include "boneImageHeader.h"
#include "boneJson.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <charconv>
#include <fstream>
#include <regex>

namespace bone
{
namespace
{
/** The text as a whole number that a label map may hold; false where it is none. */
bool
ParseLabel(const std::string & text, int & value)
{
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  return parsed.ec == std::errc() && parsed.ptr == text.data() + text.size() && value >= -32768 && value <= 32767;
}

/** Segments of 3D Slicer. Before its version 4.11 each had a layer of its own, with the value 1. */
std::vector<LabelName>
SegmentNames(const std::string & path)
{
  std::ifstream          stream(path, std::ios::binary);
  const auto             notes = ReadNrrdNotes(stream);
  std::vector<LabelName> names;
  const auto             find = [&notes](std::size_t i, const char * what) {
    const auto found = notes.find("Segment" + std::to_string(i) + "_" + what);
    return found == notes.end() ? std::string() : found->second;
  };
  for (std::size_t i = 0; !find(i, "ID").empty() || !find(i, "Name").empty(); ++i)
  {
    LabelName name{ i, 1, find(i, "Name").empty() ? find(i, "ID") : find(i, "Name") };
    int       layer = 0;
    if (ParseLabel(find(i, "Layer"), layer) && layer >= 0)
    {
      name.layer = static_cast<std::size_t>(layer);
    }
    ParseLabel(find(i, "LabelValue"), name.value);
    names.push_back(name);
  }
  return names;
}

/** The text of a NIfTI file's header extensions, which lie between header and voxels. */
std::string
NiftiExtensions(const std::string & path)
{
  constexpr std::size_t longest = std::size_t{ 1 } << 22;
  constexpr std::size_t header = 352;
  const GzFile          file = OpenGz(path);
  std::array<char, 348> raw{};
  if (!file || gzread(file.get(), raw.data(), raw.size()) != static_cast<int>(raw.size()))
  {
    return "";
  }
  const bool  swapped = Decode<std::int32_t>(raw.data(), false) != 348;
  const float offset = Decode<float>(&raw[108], swapped);
  if (!(offset > header && offset <= longest))
  {
    return "";
  }
  std::string text(static_cast<std::size_t>(offset) - raw.size(), '\0');
  return gzread(file.get(), text.data(), static_cast<unsigned int>(text.size())) == static_cast<int>(text.size()) ? text
                                                                                                                  : "";
}

/** <Label Key="12" Red="...">femur_left</Label>, or with the name in a CDATA section. */
std::vector<LabelName>
TableOfExtension(const std::string & text)
{
  static const std::regex label(R"/(<Label\s[^>]*\bKey="(-?[0-9]+)"[^>]*>\s*(?:<!\[CDATA\[)?\s*([^<\]]*))/");
  std::vector<LabelName>  names;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), label); it != std::sregex_iterator(); ++it)
  {
    LabelName name;
    if (ParseLabel((*it)[1], name.value) && name.value != 0)
    {
      name.name = Trim((*it)[2]);
      names.push_back(name);
    }
  }
  return names;
}

std::vector<LabelName>
ParseJsonTable(const nlohmann::json & document)
{
  const nlohmann::json & table = document.is_object() && document.contains("labels") ? document["labels"] : document;
  if (!table.is_object())
  {
    Refuse("is no table of label names: an object of values and names is needed");
  }
  std::vector<LabelName> names;
  for (const auto & [key, content] : table.items())
  {
    LabelName name;
    if (content.is_string() && ParseLabel(key, name.value))
    {
      name.name = content.get<std::string>();
    }
    else if (content.is_number_integer() && ParseLabel(content.dump(), name.value))
    {
      name.name = key;
    }
    else
    {
      Refuse("is no table of label names: '", key, "' has no value and name");
    }
    names.push_back(name);
  }
  return names;
}

/** A line of a table: the value, and the name in quotation marks or as the next word. False where it has no value. */
bool
ParseTableLine(const std::string & line, LabelName & name)
{
  static const std::regex pattern(
    R"/(^[\s|]*(-?[0-9]+)[\s,;|:]+(?:.*"([^"]+)"|([^\s,;|]+(?: [^\s,;|0-9][^\s,;|]*)*)).*$)/");
  std::smatch parts;
  if (!std::regex_match(line, parts, pattern) || !ParseLabel(parts[1], name.value))
  {
    return false;
  }
  name.name = parts[2].matched ? parts[2] : parts[3];
  return true;
}

std::vector<LabelName>
ParseTextTable(const std::string & path)
{
  constexpr std::size_t  longest = 1000;
  std::ifstream          stream(path);
  std::vector<LabelName> names;
  std::size_t            number = 0;
  bool                   heading = true;
  for (std::string line; std::getline(stream, line);)
  {
    ++number;
    line = Trim(line);
    if (line.empty() || line[0] == '#')
    {
      continue;
    }
    LabelName name;
    if (line.size() <= longest && ParseTableLine(line, name))
    {
      names.push_back(name);
    }
    else if (!heading)
    {
      Refuse("line ", number, " has no label value and name");
    }
    heading = heading && names.empty() && number < 3;
  }
  return names;
}
} // namespace

std::vector<LabelName>
ReadLabelNames(const std::string & path)
{
  if (HasExtension(path, ".nrrd"))
  {
    return SegmentNames(path);
  }
  if (HasExtension(path, ".nii") || HasExtension(path, ".nii.gz"))
  {
    return TableOfExtension(NiftiExtensions(path));
  }
  return {};
}

std::vector<LabelName>
ReadLabelTable(const std::string & path)
{
  RequireReadableFile(path);
  return NamingFile(path, [&] {
    auto names = HasExtension(path, ".json") ? ParseJsonTable(ReadJsonFile(path)) : ParseTextTable(path);
    names.erase(std::remove_if(names.begin(), names.end(), [](const LabelName & name) { return name.value == 0; }),
                names.end());
    if (names.empty())
    {
      Refuse("holds no table of label names: lines of a value and a name are needed");
    }
    return names;
  });
}
} // namespace bone
