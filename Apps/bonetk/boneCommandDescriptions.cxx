/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommandLine.h"
#include "boneOptions.h"

#include <algorithm>

namespace bone
{
namespace
{
std::vector<std::string>
NamesOf(const CLI::Option & option)
{
  std::vector<std::string> names;
  for (const std::string & name : option.get_snames())
  {
    names.push_back("-" + name);
  }
  for (const std::string & name : option.get_lnames())
  {
    names.push_back("--" + name);
  }
  return names;
}

OptionDescription
DescribeOption(const CLI::Option & option)
{
  OptionDescription description;
  description.positional = option.get_positional();
  description.name = description.positional ? option.get_name(true) : option.get_lnames().front();
  description.names = NamesOf(option);
  description.required = option.get_required();
  description.flag = option.get_items_expected_max() == 0;
  for (const std::string & name : option.get_lnames())
  {
    if (description.flag && name != description.name && name == "no-" + description.name)
    {
      description.negative = name;
    }
  }
  description.type = option.get_type_name();
  description.least = option.get_items_expected_min();
  constexpr int many = 1000; // what commands set where any number will do
  const int     most = option.get_items_expected_max();
  description.most = most >= many || option.get_delimiter() != '\0' ? -1 : most;
  description.each = option.get_allow_extra_args() && option.get_type_size_max() <= 1 ? 0 : option.get_type_size_max();
  description.output = IsOutput(option);
  description.help = option.get_description();
  return description;
}

void
DescribeGroup(const CLI::App & group, const std::string & before, std::vector<CommandDescription> & commands)
{
  for (const CLI::App * command : group.get_subcommands([](const CLI::App *) { return true; }))
  {
    const std::string name = before + command->get_name();
    if (!command->get_subcommands([](const CLI::App *) { return true; }).empty())
    {
      DescribeGroup(*command, name + " ", commands);
      continue;
    }
    CommandDescription description{ name, command->get_description(), {} };
    for (const CLI::Option * option : command->get_options())
    {
      if (option != command->get_help_ptr() && option != command->get_help_all_ptr())
      {
        description.options.push_back(DescribeOption(*option));
      }
    }
    std::stable_partition(description.options.begin(), description.options.end(), [](const OptionDescription & option) {
      return option.positional;
    });
    commands.push_back(std::move(description));
  }
}
} // namespace

std::vector<CommandDescription>
DescribeCommands()
{
  CLI::App app;
  Session  session(SessionStreams::Captured);
  Action   action;
  AddCommands(app, action, session);
  std::vector<CommandDescription> commands;
  DescribeGroup(app, "", commands);
  return commands;
}
} // namespace bone
