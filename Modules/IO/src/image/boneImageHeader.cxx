/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneImageHeader.h"

#include "boneFileName.h"
#include "boneImageIO.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <itk_zlib.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>

namespace bone
{
namespace
{
/** Counts, positions and spacings beyond this are none: a kilometre in micrometres. */
constexpr double LargestNumber = 1e9;
/** Longer headers are none. */
constexpr std::size_t MostFields = 10000;
constexpr std::size_t LongestLine = std::size_t{ 1 } << 20;

bool
GetField(std::istream & stream, std::string & line, std::size_t fields)
{
  return fields < MostFields && std::getline(stream, line) && line.size() < LongestLine;
}

/** The first number of a field, or of a list in it, that is not finite or too large; empty where there is none. */
std::string
FindWildNumber(std::string text)
{
  for (char & c : text)
  {
    c = std::strchr("(),;", c) != nullptr ? ' ' : c;
  }
  std::istringstream words(text);
  for (std::string word; words >> word;)
  {
    char *       end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end == '\0' && !(std::abs(value) <= LargestNumber))
    {
      return word;
    }
  }
  return "";
}

void
RequireNumbers(const std::string &                        path,
               const std::map<std::string, std::string> & fields,
               const std::set<std::string> &              names,
               double                                     mostDimensions)
{
  for (const auto & [name, text] : fields)
  {
    const std::string wild = names.count(name) > 0 ? FindWildNumber(text) : "";
    if (!wild.empty())
    {
      throw IOError(path, "is no readable image: its header's '" + name + "' holds " + wild);
    }
    const bool   dimensions = name == "NDims" || name == "dimension";
    const double count = std::strtod(text.c_str(), nullptr);
    if (dimensions && !(count >= 1.0 && count <= mostDimensions))
    {
      throw IOError(path, "is no image of three dimensions: its header's '" + name + "' is " + text);
    }
    if (name == "ElementNumberOfChannels" && std::strtod(text.c_str(), nullptr) != 1.0)
    {
      throw IOError(path, "has " + text + " components per voxel where one value is needed");
    }
  }
}

/** Refuses what MetaIO reads beyond its buffers: lines that are no "name = value", and texts as long as them. */
void
RequireMetaLines(const std::string &                        path,
                 const std::map<std::string, std::string> & fields,
                 const std::set<std::string> &              numbers)
{
  constexpr std::size_t longest = 250;
  if (fields.count("ElementDataFile") == 0)
  {
    throw IOError(path, "is no readable image: its header does not say where the voxels are (ElementDataFile)");
  }
  for (const auto & [name, text] : fields)
  {
    if (name.empty() || name.size() > longest || (text.size() > longest && numbers.count(name) == 0))
    {
      throw IOError(path, "is no readable image: its header has a line that is damaged, or too long");
    }
  }
}

/** Offsets as in nifti1.h. */
void
RequireSensibleNifti(const std::string & path)
{
  const gzFile          file = gzopen(path.c_str(), "rb");
  std::array<char, 348> header{};
  const int             read = file != nullptr ? gzread(file, header.data(), header.size()) : 0;
  gzclose(file);
  const auto dimensions = Decode<std::int16_t>(&header[40], false);
  const bool swapped = dimensions < 1 || dimensions > 7;
  if (read != static_cast<int>(header.size()) || Decode<std::int32_t>(&header[0], swapped) != 348)
  {
    return;
  }
  const auto require = [&](const char * name, std::size_t first, int count) {
    for (int i = 0; i < count; ++i)
    {
      const float value = Decode<float>(&header[first + 4 * static_cast<std::size_t>(i)], swapped);
      if (!(std::abs(value) <= LargestNumber))
      {
        throw IOError(path, Say("is no readable image: its header's ", name, " holds ", value));
      }
    }
  };
  require("voxel sizes (pixdim)", 80, 3);
  require("scale (scl_slope, scl_inter)", 112, 2);
  if (Decode<std::int16_t>(&header[252], swapped) > 0)
  {
    require("position (qform)", 256, 6);
  }
  if (Decode<std::int16_t>(&header[254], swapped) > 0)
  {
    require("position (sform)", 280, 12);
  }
}
/** The fields ("name: value"), or the notes ("name:=value"). */
std::map<std::string, std::string>
ReadNrrdLines(std::istream & stream, bool notes)
{
  std::map<std::string, std::string> lines;
  std::string                        line;
  while (GetField(stream, line, lines.size()) && !Trim(line).empty())
  {
    const auto colon = line.find(':');
    if (colon != std::string::npos && line[0] != '#' && (line.compare(colon, 2, ":=") == 0) == notes)
    {
      lines[Trim(line.substr(0, colon))] = Trim(line.substr(colon + (notes ? 2 : 1)));
    }
  }
  return lines;
}
} // namespace

std::string
Trim(const std::string & text)
{
  const char * blanks = " \t\r";
  const auto   first = text.find_first_not_of(blanks);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::map<std::string, std::string>
ReadMetaHeader(std::istream & stream)
{
  std::map<std::string, std::string> fields;
  std::string                        line;
  while (fields.count("ElementDataFile") == 0 && GetField(stream, line, fields.size()))
  {
    const auto equals = line.find('=');
    if (equals != std::string::npos)
    {
      fields[Trim(line.substr(0, equals))] = Trim(line.substr(equals + 1));
    }
    else if (!Trim(line).empty())
    {
      fields[""] = line; // no field
    }
  }
  return fields;
}

std::map<std::string, std::string>
ReadNrrdHeader(std::istream & stream)
{
  return ReadNrrdLines(stream, false);
}

std::map<std::string, std::string>
ReadNrrdNotes(std::istream & stream)
{
  return ReadNrrdLines(stream, true);
}

bool
HasDetachedVoxels(const std::string & path)
{
  const auto    has = [&path](const char * extension) { return HasExtension(path, extension); };
  const auto    pairs = { ".nhdr", ".hdr", ".img", ".hdr.gz", ".img.gz" };
  std::ifstream stream(path, std::ios::binary);
  if (has(".mha") || has(".mhd"))
  {
    const std::string data = ReadMetaHeader(stream)["ElementDataFile"];
    return data != "LOCAL" && data != "Local" && data != "local";
  }
  if (has(".nrrd"))
  {
    const auto fields = ReadNrrdHeader(stream);
    return fields.count("data file") + fields.count("datafile") > 0;
  }
  return std::any_of(pairs.begin(), pairs.end(), has);
}

void
RequireSensibleHeader(const std::string & path)
{
  std::ifstream stream(path, std::ios::binary);
  if (HasExtension(path, ".mha") || HasExtension(path, ".mhd"))
  {
    const auto                  fields = ReadMetaHeader(stream);
    const std::set<std::string> numbers{ "TransformMatrix", "Rotation", "Orientation",      "Offset",
                                         "Position",        "Origin",   "CenterOfRotation", "ElementSpacing",
                                         "ElementSize",     "DimSize",  "HeaderSize" };
    RequireMetaLines(path, fields, numbers);
    RequireNumbers(path, fields, numbers, 10.0);
  }
  else if (HasExtension(path, ".nrrd") || HasExtension(path, ".nhdr"))
  {
    RequireNumbers(
      path, ReadNrrdHeader(stream), { "sizes", "spacings", "space directions", "space origin", "dimension" }, 16.0);
  }
  else
  {
    RequireSensibleNifti(path);
  }
}
} // namespace bone
