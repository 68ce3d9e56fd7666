/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneRegisteredSubjects.h"

#include "boneFileName.h"
#include "boneIOError.h"
#include "boneParameterOptions.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
namespace fs = std::filesystem;

std::string
WithoutNumber(const std::string & name)
{
  const auto end = std::find_if(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) == 0; });
  const auto digits = static_cast<std::size_t>(end - name.begin());
  const bool numbered = digits >= 4 && digits + 1 < name.size() && name[digits] == '_';
  return numbered ? name.substr(digits + 1) : name;
}

std::string
RecordOf(const std::string & folder)
{
  return folder + "/requests.jsonl";
}
} // namespace

void
SubjectRegistrationOptions::AddTo(CLI::App * command)
{
  command->add_option("--degree", degree, "Degree of densities that are fitted, 0 to 8; default 2")
    ->check(CLI::Range(0, MaximumBernsteinDegree).description(""));
  AddParameterOptions(command, parameters, { "mirror", "method", "interior", "exteriorBound" });
}

FileTrainingSet::Pointer
ListRegistered(const std::string & folder)
{
  std::error_code          error;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
  {
    const std::string name = entry->path().filename().string();
    if (name.front() != '.' && HasExtension(name, ".vtu"))
    {
      names.push_back(name);
    }
  }
  if (error)
  {
    throw IOError(folder, "cannot read the folder: " + error.message());
  }
  if (names.empty())
  {
    throw IOError(folder, "the folder holds no meshes (.vtu)");
  }
  std::sort(names.begin(), names.end());
  auto set = FileTrainingSet::New();
  for (const std::string & name : names)
  {
    set->AddSubject(WithoutNumber(fs::path(name).stem().string()), folder + '/' + name);
  }
  return set;
}

DensityMesh<double>::Pointer
ReadStandard(const std::string & path)
{
  if (HasExtension(path, ".h5"))
  {
    auto mesh = DensityMesh<double>::New();
    mesh->SetArrays(ReadStatisticalModel(path)->GetContent().mean);
    return mesh;
  }
  if (!HasExtension(path, ".vtu"))
  {
    throw UsageError("the standard model " + path + " must be a mesh (.vtu) or an atlas (.h5)");
  }
  return ReadDensityMesh(path);
}

MeshArrays
BringSubject(PopulationRegistration & population, const SubjectFiles & subject)
{
  try
  {
    return population.Bring(subject);
  }
  catch (const IOError &)
  {
    throw;
  }
  catch (const itk::ExceptionObject & error)
  {
    throw IOError(subject.shape, ErrorLine(error));
  }
}

std::string
DescribeRegistration(const SubjectFiles & subject, PopulationRegistration & population)
{
  std::ostringstream os;
  os << std::left << std::setw(28) << subject.name << std::setprecision(3);
  if (!population.WasRegistered())
  {
    os << "on the standard model's topology";
  }
  else
  {
    const RegistrationReport & report = population.GetFilter()->GetReport();
    os << report.surfaceDistance << " mm to the subject, " << report.subjectDistance << " mm back"
       << (report.mirrored ? ", mirrored" : "");
    if (report.untangling.before > 0)
    {
      os << ", " << report.untangling.before << " inverted tetrahedra repaired";
    }
  }
  os << '\n';
  return os.str();
}

std::string
RegisteredName(std::size_t number, const SubjectFiles & subject)
{
  std::ostringstream name;
  name << std::setw(4) << std::setfill('0') << number + 1 << '_' << subject.name << ".vtu";
  return name.str();
}

RegistrationRecord::RegistrationRecord(const std::string & folder)
  : m_Folder(folder)
{
  std::ifstream stream(RecordOf(folder));
  for (std::string line; std::getline(stream, line);)
  {
    const auto entry = nlohmann::json::parse(line, nullptr, false); // the last one may have been cut off
    if (entry.is_object() && entry.contains("file") && entry["file"].is_string())
    {
      m_Requests[entry["file"].get<std::string>()] = entry;
    }
  }
}

bool
RegistrationRecord::Holds(const std::string & file, const nlohmann::json & request) const
{
  const auto      entry = m_Requests.find(file);
  std::error_code error;
  const auto      bytes = fs::file_size(m_Folder + '/' + file, error);
  return !error && !request.is_null() && entry != m_Requests.end() &&
         entry->second.value("request", nlohmann::json()) == request &&
         entry->second.value("bytes", nlohmann::json()) == bytes;
}

void
RegistrationRecord::Note(const std::string & file, const nlohmann::json & request)
{
  if (request.is_null())
  {
    return;
  }
  const nlohmann::json entry{ { "file", file },
                              { "bytes", fs::file_size(m_Folder + '/' + file) },
                              { "request", request } };
  std::ofstream        stream(RecordOf(m_Folder), std::ios::app);
  stream << (m_Requests.empty() ? "" : "\n") << entry.dump() << std::flush; // after one that was cut off too
  if (!stream)
  {
    RefuseToWrite(RecordOf(m_Folder), "cannot write", errno);
  }
  m_Requests[file] = entry;
}
} // namespace bone
