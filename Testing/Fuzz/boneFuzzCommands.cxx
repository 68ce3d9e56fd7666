/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFuzzCommands.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>
#include <sstream>

namespace bone
{
namespace
{
namespace fs = std::filesystem;

std::vector<std::string>
Words(const std::string & line)
{
  std::istringstream stream(line);
  return { std::istream_iterator<std::string>(stream), {} };
}

std::set<std::string>
Listing(const std::string & folder)
{
  std::set<std::string> names;
  for (const auto & entry : fs::recursive_directory_iterator(folder))
  {
    names.insert(entry.path().string());
  }
  return names;
}

/** What is wrong with the lines on standard error; the error, where there is one, is the last. */
std::string
FindLineFault(const std::string &              text,
              bool                             failed,
              const std::string &              command,
              const std::vector<std::string> & names)
{
  std::istringstream       stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);)
  {
    lines.push_back(line);
  }
  if (failed && (lines.empty() || text.back() != '\n'))
  {
    return "no line says why";
  }
  const std::string heading = "bonetk " + command + ": ";
  for (const std::string & line : lines)
  {
    const bool error = failed && &line == &lines.back();
    const bool warning = line.find("warning: ") != std::string::npos;
    if (line.rfind(heading, 0) != 0 || error == warning)
    {
      return "'" + line + "' is no line of bonetk's";
    }
    if (const std::string fault = FindMessageFault(line); !fault.empty())
    {
      return "'" + line + "' " + fault;
    }
  }
  const auto holds = [&](const std::string & name) { return lines.back().find(name) != std::string::npos; };
  if (failed && std::none_of(names.begin(), names.end(), holds))
  {
    return "'" + lines.back() + "' does not name " + names.front();
  }
  return "";
}

/** Removes what a command wrote, and says what it must not have left. */
std::string
ClearOutputs(const std::set<std::string> & before, const std::string & folder, bool failed)
{
  std::string left;
  for (const std::string & name : Listing(folder))
  {
    const bool hidden = fs::path(name).filename().string()[0] == '.';
    if (before.count(name) == 0)
    {
      left = failed || hidden ? name : left;
      fs::remove_all(name);
    }
  }
  return left.empty() ? "" : "it leaves " + left;
}
} // namespace

ChildEnd
RunCommand(const std::string &              program,
           const std::string &              line,
           const std::vector<std::string> & names,
           const std::string &              folder,
           const std::string &              log)
{
  std::vector<std::string> words = Words(line);
  const std::string        command = words[0] == "register" ? words[0] + ' ' + words[1] : words[0];
  words.insert(words.begin(), program);
  words.insert(words.end(), { "--threads", "1" });
  const auto        before = Listing(folder);
  ChildEnd          end = RunProgram(words, folder, log);
  const std::string left = ClearOutputs(before, folder, end.code != 0);
  if (end.wrong.empty() && (end.code < 0 || end.code > 2))
  {
    end.wrong = "exit code " + std::to_string(end.code);
  }
  if (end.wrong.empty())
  {
    end.wrong = FindLineFault(ReadBytes(log), end.code != 0, command, names);
  }
  if (end.wrong.empty())
  {
    end.wrong = left;
  }
  return end;
}
} // namespace bone
