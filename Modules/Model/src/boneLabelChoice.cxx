/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelChoice.h"

#include "boneLabelValue.h"

#include <itksys/Glob.hxx>
#include <itksys/RegularExpression.hxx>
#include <itksys/SystemTools.hxx>

#include <algorithm>

namespace bone
{
namespace
{
/** A label that occurs. */
struct Entry
{
  std::size_t layer{ 0 };
  LabelCount  count;
};

std::vector<Entry>
Entries(const LabelFile & file)
{
  std::vector<Entry> entries;
  for (std::size_t layer = 0; layer < file.layers.size(); ++layer)
  {
    for (LabelCount & count : CountLabels(file.layers[layer]))
    {
      const auto named = std::find_if(file.names.begin(), file.names.end(), [&](const LabelName & name) {
        return name.layer == layer && name.value == count.value;
      });
      count.name = named == file.names.end() ? "" : named->name;
      entries.push_back({ layer, std::move(count) });
    }
  }
  return entries;
}

std::string
List(const std::vector<Entry> & entries)
{
  std::vector<LabelCount> counts;
  std::transform(entries.begin(), entries.end(), std::back_inserter(counts), [](const Entry & e) { return e.count; });
  return counts.empty() ? "it is 0 everywhere" : "it has " + ListLabels(counts);
}

/** The entries that a word means: by value, else by name, else by name whatever its case. */
std::vector<Entry>
Find(const std::vector<Entry> & entries, const std::string & wanted)
{
  const auto lower = [](const std::string & text) { return itksys::SystemTools::LowerCase(text); };
  const auto find = [&entries](auto && matches) {
    std::vector<Entry> found;
    std::copy_if(entries.begin(), entries.end(), std::back_inserter(found), matches);
    return found;
  };
  auto found = find([&](const Entry & entry) { return std::to_string(entry.count.value) == wanted; });
  found = found.empty() ? find([&](const Entry & entry) { return entry.count.name == wanted; }) : found;
  return found.empty() ? find([&](const Entry & entry) { return lower(entry.count.name) == lower(wanted); }) : found;
}

bool
IsPattern(const std::string & word)
{
  return word.find_first_of("*?") != std::string::npos;
}

/** The entries whose names, whatever their case, or values, where they have none, a pattern of * and ? means. */
std::vector<Entry>
FindAll(const std::vector<Entry> & entries, const std::string & pattern)
{
  const auto                lower = [](const std::string & text) { return itksys::SystemTools::LowerCase(text); };
  itksys::RegularExpression expression(itksys::Glob::PatternToRegex(lower(pattern), true, true));
  std::vector<Entry>        found;
  std::copy_if(entries.begin(), entries.end(), std::back_inserter(found), [&](const Entry & entry) {
    return expression.find(entry.count.name.empty() ? std::to_string(entry.count.value) : lower(entry.count.name));
  });
  return found;
}

LabelledBone
ToBone(const LabelFile & file, const Entry & entry)
{
  return { file.layers[entry.layer], entry.count.value, entry.count.name, entry.count.region, file.source };
}

/** The smallest box that holds all labels. */
CTImage::RegionType
BoxOfAll(const std::vector<Entry> & entries)
{
  CTImage::IndexType lower = entries.front().count.region.GetIndex();
  CTImage::IndexType upper = entries.front().count.region.GetUpperIndex();
  for (const Entry & entry : entries)
  {
    for (unsigned int d = 0; d < 3; ++d)
    {
      lower[d] = std::min(lower[d], entry.count.region.GetIndex(d));
      upper[d] = std::max(upper[d], entry.count.region.GetUpperIndex()[d]);
    }
  }
  CTImage::RegionType box;
  box.SetIndex(lower);
  box.SetUpperIndex(upper);
  return box;
}

LabelledBone
TheOnlyBone(const LabelFile & file, const std::vector<Entry> & entries)
{
  if (entries.size() == 1)
  {
    return ToBone(file, entries.front());
  }
  if (entries.empty())
  {
    itkGenericExceptionMacro("The label map has no voxel of any label; it is 0 everywhere");
  }
  if (file.layers.size() == 1 && StatesOneBone(*file.layers.front()))
  {
    return { file.layers.front(), 0, "", BoxOfAll(entries), file.source };
  }
  itkGenericExceptionMacro("The label map has several labels, and which of them is the bone was not said; "
                           << List(entries));
}
} // namespace

std::vector<LabelCount>
CountLabels(const LabelFile & file)
{
  std::vector<LabelCount> counts;
  for (Entry & entry : Entries(file))
  {
    counts.push_back(std::move(entry.count));
  }
  return counts;
}

std::vector<LabelledBone>
ChooseBones(const LabelFile & file, const std::vector<std::string> & wanted)
{
  const std::vector<Entry> entries = Entries(file);
  if (wanted.empty())
  {
    return { TheOnlyBone(file, entries) };
  }
  std::vector<LabelledBone> bones;
  for (const std::string & word : wanted)
  {
    std::vector<Entry> found = Find(entries, word);
    const bool         isPattern = found.empty() && IsPattern(word);
    found = isPattern ? FindAll(entries, word) : found;
    if (found.empty())
    {
      itkGenericExceptionMacro("The label map has no label " << word << "; " << List(entries));
    }
    if (found.size() > 1 && !isPattern)
    {
      itkGenericExceptionMacro("Of the labels of the map " << found.size() << " are called " << word << "; "
                                                           << List(entries));
    }
    for (const Entry & entry : found)
    {
      bones.push_back(ToBone(file, entry));
    }
  }
  return bones;
}
} // namespace bone
