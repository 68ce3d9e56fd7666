/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
// boneManual FOLDER: writes FOLDER/man1 and FOLDER/completions.
#include "boneCompletions.h"
#include "boneManualPages.h"

#include <filesystem>
#include <fstream>
#include <iostream>

namespace
{
bool
Write(const std::filesystem::path & folder, const bone::TextFile & content)
{
  std::filesystem::create_directories(folder);
  std::ofstream file(folder / content.name, std::ios::binary);
  file << content.text;
  file.close();
  if (!file)
  {
    std::cerr << "boneManual: " << folder / content.name << " cannot be written\n";
  }
  return static_cast<bool>(file);
}
} // namespace

int
main(int argc, char ** argv)
{
  if (argc != 2)
  {
    std::cerr << "usage: boneManual FOLDER\n";
    return 2;
  }
  std::vector<bone::CommandDescription> commands = bone::DescribeCommands();
  for (bone::CommandDescription & command : commands)
  {
    bone::OptionDescription help;
    help.name = "help";
    help.names = { "-h", "--help" };
    help.flag = true;
    help.help = "Print the options and exit";
    command.options.push_back(help);
  }
  const std::filesystem::path folder(argv[1]);
  bool                        written = true;
  for (const bone::TextFile & page : bone::MakeManualPages(commands))
  {
    written = Write(folder / "man1", page) && written;
  }
  written = Write(folder / "completions", { "bonetk.bash", bone::MakeBashCompletion(commands) }) && written;
  written = Write(folder / "completions", { "_bonetk", bone::MakeZshCompletion(commands) }) && written;
  written = Write(folder / "completions", { "bonetk.fish", bone::MakeFishCompletion(commands) }) && written;
  return written ? 0 : 1;
}
