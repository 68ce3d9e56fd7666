/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneHierarchyIO.h"

#include "boneAtomicFile.h"
#include "boneJson.h"
#include "boneMeshIO.h"
#include "boneOutputTransaction.h"
#include "boneRefuse.h"
#include "boneVtkFile.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

namespace bone
{
namespace
{
namespace fs = std::filesystem;
using nlohmann::json;
using Level = DensityHierarchy<>::Level;

json
FromLevel(const Level & level, const std::string & file)
{
  json object;
  object["file"] = fs::path(file).filename().string();
  object["points"] = level.mesh->GetNumberOfPoints();
  object["tetrahedra"] = level.mesh->GetNumberOfTetrahedra();
  object["densityErrorBound"] = level.densityErrorBound < 0 ? json(nullptr) : json(level.densityErrorBound);
  object["densityError"] = level.densityError;
  object["surfaceError"] = level.surfaceError;
  object["stopReason"] = level.stopReason;
  object["parentPoint"] = level.parentPoint;
  return object;
}

// Each point's id in the level before, which has `parents` points.
std::vector<IdType>
ParentPoints(const json & object, std::size_t points, std::size_t parents, bool first)
{
  const json & list = Member(object, "parentPoint");
  if (!list.is_array() || list.size() != (first ? 0 : points))
  {
    Refuse("'parentPoint' must be a list of ", first ? 0 : points, " ids");
  }
  std::vector<IdType> ids;
  for (const json & id : list)
  {
    if (!id.is_number_integer() || id.get<long long>() < 0 || id.get<long long>() >= static_cast<long long>(parents))
    {
      Refuse("'parentPoint' has an entry that is no id of the ", parents, " points of the level before");
    }
    ids.push_back(id.get<IdType>());
  }
  return ids;
}

Level
ToLevel(const json & object, const fs::path & folder, const Level * before)
{
  Level             level;
  const std::string name = FileMember(object, "file");
  const std::string file = (folder / name).string();
  try
  {
    level.mesh = ReadDensityMesh(file);
  }
  catch (const IOError & error)
  {
    Refuse(ErrorLine(error)); // the hierarchy's name goes before it
  }
  const auto points = static_cast<long long>(level.mesh->GetNumberOfPoints());
  const auto tetrahedra = static_cast<long long>(level.mesh->GetNumberOfTetrahedra());
  const auto highest = std::numeric_limits<IdType>::max();
  if (WholeMember(object, "points", 0, highest) != points ||
      WholeMember(object, "tetrahedra", 0, highest) != tetrahedra)
  {
    Refuse("the file '", name, "' has ", points, " points and ", tetrahedra, " tetrahedra, not those given");
  }
  const bool bounded = object.contains("densityErrorBound") && !object["densityErrorBound"].is_null();
  level.densityErrorBound = bounded ? NumberMember(object, "densityErrorBound") : -1.0;
  level.densityError = NumberMember(object, "densityError");
  level.surfaceError = NumberMember(object, "surfaceError");
  level.stopReason = TextMember(object, "stopReason");
  level.parentPoint = ParentPoints(object,
                                   static_cast<std::size_t>(points),
                                   before != nullptr ? before->mesh->GetNumberOfPoints() : 0,
                                   before == nullptr);
  return level;
}

/** The levels of the hierarchy under this name that are not among `paths`, which replace it. */
std::vector<std::string>
FormerLevels(const std::string & jsonPath, const std::vector<std::string> & paths)
{
  std::vector<std::string> files;
  json                     former;
  try
  {
    former = ReadJsonFile(jsonPath);
  }
  catch (const IOError &)
  {
    return files; // there is none
  }
  for (const json & level : former.is_object() && former.contains("levels") ? former["levels"] : json::array())
  {
    const auto        entry = level.find("file");
    const std::string name = entry != level.end() && entry->is_string() ? entry->get<std::string>() : "";
    const std::string file = (fs::path(jsonPath).parent_path() / name).string();
    if (HasExtension(name, ".vtu") && fs::path(name).filename() == name &&
        std::find(paths.begin(), paths.end(), file) == paths.end())
    {
      files.push_back(file);
    }
  }
  return files;
}
} // namespace

std::vector<std::string>
WriteHierarchy(const DensityHierarchy<> * hierarchy, const std::string & prefix, const MeshStorageParameters & storage)
{
  const std::string                        jsonPath = prefix + ".hierarchy.json";
  std::vector<std::unique_ptr<AtomicFile>> files;
  std::vector<std::string>                 paths;
  json                                     document;
  document["levels"] = json::array();
  for (const Level & level : hierarchy->GetLevels())
  {
    paths.push_back(Say(prefix, "_L", paths.size() + 1, ".vtu"));
    files.push_back(std::make_unique<AtomicFile>(paths.back()));
    NamingFile(paths.back(), [&] { WriteMeshFile(level.mesh->GetArrays(), storage, *files.back()); });
    document["levels"].push_back(FromLevel(level, paths.back()));
  }
  files.push_back(std::make_unique<AtomicFile>(jsonPath));
  paths.push_back(jsonPath);
  files.back()->Write(document.dump(1) + '\n');
  const std::vector<std::string> outOfDate = FormerLevels(jsonPath, paths);
  for (const auto & file : files)
  {
    file->Commit();
  }
  OutputTransaction::Take({}, outOfDate, nullptr);
  return paths;
}

DensityHierarchy<>::Pointer
ReadHierarchy(const std::string & path)
{
  const json document = ReadJsonFile(path);
  auto       hierarchy = DensityHierarchy<>::New();
  const json list = NamingFile(path, [&] { return Member(document, "levels"); });
  if (!list.is_array() || list.empty())
  {
    throw IOError(path, "'levels' must be a list of one level or more");
  }
  std::vector<Level> levels;
  for (const json & object : list)
  {
    NamingFile(Say(path, ": level ", levels.size() + 1), [&] {
      levels.push_back(ToLevel(object, fs::path(path).parent_path(), levels.empty() ? nullptr : &levels.back()));
    });
  }
  hierarchy->SetLevels(std::move(levels));
  return hierarchy;
}
} // namespace bone
