/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildRequest.h"

#include "boneBuildInformation.h"
#include "boneFileName.h"
#include "boneIOError.h"
#include "boneImageIO.h"
#include "boneProvenance.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace bone
{
namespace
{
namespace fs = std::filesystem;

/** The report of a folder's build; null where there is none that can be read. */
nlohmann::json
ReadReport(const std::string & folder)
{
  std::ifstream stream(folder + "/report.json");
  return stream ? nlohmann::json::parse(stream, nullptr, false) : nlohmann::json();
}

/** Whether the report is of this request, and all is there that it names. */
bool
IsWhole(const std::string & folder, const nlohmann::json & report, const nlohmann::json & request)
{
  if (request.is_null() || !report.is_object() || report.value("request", nlohmann::json()) != request)
  {
    return false;
  }
  const auto outputs = report.value("outputs", nlohmann::json());
  const auto warnings = report.value("warnings", nlohmann::json());
  const auto isText = [](const nlohmann::json & value) { return value.is_string(); };
  if (!outputs.is_object() || outputs.empty() || !warnings.is_array() ||
      !std::all_of(warnings.begin(), warnings.end(), isText))
  {
    return false; // of another version, or damaged
  }
  return std::all_of(outputs.items().begin(), outputs.items().end(), [&folder](const auto & output) {
    std::error_code error;
    const auto      bytes = fs::file_size(folder + "/" + output.key(), error);
    return !error && output.value() == bytes;
  });
}

/** The folders of all bones that were built together by this request, as any of them has it; none where none is there.
 */
std::vector<std::string>
BonesIn(const std::string & folder, const nlohmann::json & request)
{
  std::error_code error;
  for (const auto & entry : fs::directory_iterator(folder, error))
  {
    const auto report = ReadReport(entry.path().string());
    const auto bones = report.is_object() ? report.value("bones", nlohmann::json()) : nlohmann::json();
    if (bones.is_array() && IsWhole(entry.path().string(), report, request))
    {
      return bones.get<std::vector<std::string>>();
    }
  }
  return {};
}

void
TellFormer(const std::string & folder, const nlohmann::json & report, Session & session)
{
  for (const auto & warning : report["warnings"])
  {
    session.Warn(warning.get<std::string>());
  }
  session.kept.push_back(folder);
}

void
SayDone(const std::string & folder, Session & session)
{
  session.Print(folder + " is done: the same inputs, parameters and program as before; --force builds it anew\n");
}
} // namespace

nlohmann::json
DescribeRequest(const std::vector<std::pair<std::string, std::string>> & inputs, nlohmann::json options)
{
  if (GetBuildInformation().changed)
  {
    return {};
  }
  nlohmann::json request{ { "program", DescribeVersion() }, { "options", std::move(options) } };
  try
  {
    for (const auto & [role, path] : inputs)
    {
      if (path.empty())
      {
        continue;
      }
      if (std::error_code error; !fs::is_directory(path, error))
      {
        RequireReadableFile(path); // no pipe
      }
      if (HasDetachedVoxels(path))
      {
        return {};
      }
      const InputFile file = DescribeInput(path);
      request["inputs"][role] = { { "bytes", file.bytes }, { "md5", file.md5 } };
    }
  }
  catch (const IOError &)
  {
    return {}; // who needs the file says what is wrong with it
  }
  return request;
}

bool
IsBuilt(const std::string & folder, const nlohmann::json & request, Session & session)
{
  const auto report = ReadReport(folder);
  if (!IsWhole(folder, report, request))
  {
    return false;
  }
  TellFormer(folder, report, session);
  SayDone(folder, session);
  return true;
}

bool
AreBuilt(const std::string & folder, const nlohmann::json & request, Session & session)
{
  std::vector<std::pair<std::string, nlohmann::json>> reports;
  for (const std::string & bone : BonesIn(folder, request))
  {
    reports.emplace_back(bone, ReadReport(folder + "/" + bone));
    if (!IsWhole(folder + "/" + bone, reports.back().second, request))
    {
      return false;
    }
  }
  if (reports.empty())
  {
    return false;
  }
  const std::size_t common = session.GetWarnings().size();
  for (const auto & [bone, report] : reports)
  {
    session.subject = bone;
    TellFormer(folder + "/" + bone, report, session);
    session.ForgetWarnings(common); // as another bone may have the same
  }
  session.subject.clear();
  SayDone(folder, session);
  return true;
}
} // namespace bone
