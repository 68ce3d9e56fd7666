/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSvgIds.h"

#include <cstddef>
#include <map>
#include <utility>

namespace bone
{
namespace
{
/** What stands before an id, and the character after it. */
constexpr std::pair<const char *, char> IdPlaces[] = { { " id=\"", '"' }, { "href=\"#", '"' }, { "url(#", ')' } };
} // namespace

std::string
RenameSvgIds(const std::string & svg, const std::string & prefix)
{
  std::map<std::string, std::string> names;
  const std::string                  definition = IdPlaces[0].first;
  for (std::size_t at = svg.find(definition); at != std::string::npos; at = svg.find(definition, at + 1))
  {
    const std::size_t begin = at + definition.size();
    const std::string id = svg.substr(begin, svg.find('"', begin) - begin);
    names.emplace(id, prefix + "-" + std::to_string(names.size() + 1));
  }
  std::string renamed = svg;
  for (const auto & [before, after] : IdPlaces)
  {
    std::string       text;
    const std::string mark = before;
    std::size_t       done = 0;
    for (std::size_t at = renamed.find(mark); at != std::string::npos; at = renamed.find(mark, done))
    {
      const std::size_t begin = at + mark.size();
      const std::size_t end = renamed.find(after, begin);
      const auto        name = names.find(renamed.substr(begin, end - begin));
      text += renamed.substr(done, begin - done);
      text += name == names.end() ? renamed.substr(begin, end - begin) : name->second;
      done = end;
    }
    renamed = text + renamed.substr(done);
  }
  return renamed;
}
} // namespace bone
