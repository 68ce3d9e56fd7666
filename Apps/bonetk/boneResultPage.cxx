/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneResultPage.h"

#include "boneBuildInformation.h"

#include <filesystem>

namespace bone
{
void
PageOption::AddTo(CLI::App * command)
{
  command->add_flag("--no-page", m_Off, "Do not write the page (.html) that shows the result");
}

std::string
PageOption::NameOf(const std::string & output) const
{
  if (m_Off || output.empty())
  {
    return "";
  }
  std::filesystem::path path(output);
  for (const char * extension : { ".mrk.json", ".json", ".h5", ".inp", ".feb", ".msh", ".vtu" })
  {
    const std::string name = path.filename().string();
    const std::size_t length = std::char_traits<char>::length(extension);
    if (name.size() > length && name.compare(name.size() - length, length, extension) == 0)
    {
      return path.replace_filename(name.substr(0, name.size() - length) + ".html").string();
    }
  }
  return output + ".html";
}

void
WritePage(ReportPage &                                        page,
          const std::string &                                 path,
          const Session &                                     session,
          std::vector<ParameterValue>                         parameters,
          const std::vector<std::pair<std::string, double>> & seconds)
{
  Provenance provenance;
  provenance.version = "bonetk " + DescribeVersion();
  provenance.command = session.commandLine;
  provenance.machine = DescribeMachine();
  provenance.time = TimeNow();
  provenance.parameters = std::move(parameters);
  provenance.seconds = seconds;
  std::vector<std::string> seen;
  for (const std::string & input : session.inputs)
  {
    std::error_code error;
    const bool      again = std::find(seen.begin(), seen.end(), input) != seen.end();
    if (!again && (std::filesystem::is_regular_file(input, error) || std::filesystem::is_directory(input, error)))
    {
      provenance.inputs.push_back(DescribeInput(input));
      seen.push_back(input);
    }
  }
  page.SetWarnings(session.GetWarnings());
  page.AddProvenance(provenance);
  page.Write(path);
}
} // namespace bone
