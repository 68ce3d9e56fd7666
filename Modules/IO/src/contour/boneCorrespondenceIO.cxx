/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCorrespondenceIO.h"

#include "boneAtomicFile.h"
#include "boneJson.h"
#include "boneRefuse.h"

#include <limits>

namespace bone
{
namespace
{
using nlohmann::json;

std::vector<int>
IdsMember(const json & object, const char * name)
{
  const json & list = Member(object, name);
  if (!list.is_array())
  {
    Refuse("'", name, "' must be a list of contour ids");
  }
  std::vector<int> ids;
  for (const json & id : list)
  {
    if (!id.is_number_integer())
    {
      Refuse("'", name, "' must hold whole numbers, contour ids");
    }
    ids.push_back(id.get<int>());
  }
  return ids;
}

const json &
ListMember(const json & object, const char * name)
{
  const json & list = Member(object, name);
  if (!list.is_array())
  {
    Refuse("'", name, "' must be a list");
  }
  return list;
}
} // namespace

ContourCorrespondence
ReadCorrespondence(const std::string & path)
{
  const json document = ReadJsonFile(path);
  return NamingFile(path, [&] {
    ContourCorrespondence correspondence;
    RequireMembersAmong(document, { "slabs" });
    for (const json & slab : ListMember(document, "slabs"))
    {
      RequireMembersAmong(slab, { "slice", "groups" });
      const int slice = static_cast<int>(WholeMember(slab, "slice", 0, std::numeric_limits<int>::max()));
      if (correspondence.slabs.count(slice) > 0)
      {
        Refuse("slice ", slice, " is there twice");
      }
      auto & groups = correspondence.slabs[slice];
      for (const json & group : ListMember(slab, "groups"))
      {
        RequireMembersAmong(group, { "lower", "upper" });
        groups.push_back({ IdsMember(group, "lower"), IdsMember(group, "upper") });
      }
    }
    return correspondence;
  });
}

void
WriteCorrespondence(const ContourCorrespondence & correspondence, const std::string & path)
{
  json slabs = json::array();
  for (const auto & [slice, groups] : correspondence.slabs)
  {
    json list = json::array();
    for (const auto & group : groups)
    {
      list.push_back({ { "lower", group.lower }, { "upper", group.upper } });
    }
    slabs.push_back({ { "slice", slice }, { "groups", list } });
  }
  WriteFileAtomically(path, json{ { "slabs", slabs } }.dump(1) + '\n');
}
} // namespace bone
