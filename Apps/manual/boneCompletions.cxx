/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCompletions.h"

#include <algorithm>
#include <map>
#include <sstream>

namespace bone
{
namespace
{
/** What an option's value, or that at a place, is completed with. */
enum class Candidates
{
  None, ///< a number, or a name that no table has
  Files,
  Choices
};

Candidates
CandidatesOf(const OptionDescription & option)
{
  const bool capital = std::any_of(option.type.begin(), option.type.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  return option.type.find('|') != std::string::npos && !capital ? Candidates::Choices
         : option.type == "TEXT" || option.type == "FILE"       ? Candidates::Files
                                                                : Candidates::None;
}

/** "linear log" of "linear|log". */
std::string
Choices(const OptionDescription & option)
{
  std::string text = option.type;
  std::replace(text.begin(), text.end(), '|', ' ');
  return text;
}

/** The commands that hold others: "register" and what it holds, by their last words. */
std::map<std::string, std::vector<std::string>>
GroupsOf(const std::vector<CommandDescription> & commands)
{
  std::map<std::string, std::vector<std::string>> groups;
  for (const CommandDescription & command : commands)
  {
    const std::size_t space = command.name.find(' ');
    if (space != std::string::npos)
    {
      groups[command.name.substr(0, space)].push_back(command.name.substr(space + 1));
    }
  }
  return groups;
}

struct Entry
{
  std::string word;
  std::string help;
};

/** What follows `bonetk`, or the name of a group: commands, and groups once, in the order of the program's help. */
std::vector<Entry>
EntriesOf(const std::vector<CommandDescription> & commands, const std::string & group = "")
{
  const std::string  before = group.empty() ? "" : group + ' ';
  std::vector<Entry> entries;
  for (const CommandDescription & command : commands)
  {
    if (command.name.compare(0, before.size(), before) != 0)
    {
      continue;
    }
    const std::string rest = command.name.substr(before.size());
    const std::string word = rest.substr(0, rest.find(' '));
    const bool        alone = word == rest;
    if (entries.empty() || entries.back().word != word)
    {
      entries.push_back({ word, alone ? command.help : "Has commands of its own" });
    }
  }
  return entries;
}

std::string
WordsOf(const std::vector<Entry> & entries)
{
  std::string words;
  for (const Entry & entry : entries)
  {
    words += (words.empty() ? "" : " ") + entry.word;
  }
  return words;
}

std::string
Replace(std::string text, const std::string & from, const std::string & to)
{
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
  {
    text.replace(at, from.size(), to);
  }
  return text;
}

/** In single quotes for a shell that knows no escape within them. */
std::string
Quoted(const std::string & text)
{
  return '\'' + Replace(text, "'", "'\\''") + '\'';
}

constexpr const char * bashHead = R"(# Completion of bonetk in bash. Made from the program's options: do not edit.
_bonetk()
{
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local command="" values="" words="" i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command ${COMP_WORDS[i]}" in
      COMMANDS) command="$command ${COMP_WORDS[i]}" ;;
      *) break ;;
    esac
  done
  COMPREPLY=()
  # What stands for the value of the option before: choices, files, or none that could be listed.
  case "$command $previous" in
)";

constexpr const char * bashTail = R"(  esac
  if [ "$values" = FILES ] || { [ -z "$values" ] && [ -z "$only" ] && [ "${current:0:1}" != - ]; }; then
    compopt -o default 2> /dev/null
    return
  fi
  [ "$values" != NONE ] || return
  mapfile -t COMPREPLY < <(compgen -W "${values:-$words}" -- "$current")
}
complete -F _bonetk bonetk
)";
} // namespace

std::string
MakeBashCompletion(const std::vector<CommandDescription> & commands)
{
  const auto                         groups = GroupsOf(commands);
  std::string                        names;
  std::map<std::string, std::string> patterns; // by what the options take
  std::ostringstream                 words;
  for (const auto & group : groups)
  {
    names += (names.empty() ? "\" " : " | \" ") + group.first + '"';
  }
  for (const CommandDescription & command : commands)
  {
    names += (names.empty() ? "\" " : " | \" ") + command.name + '"';
    words << "    \" " << command.name << "\") words=\"";
    for (const OptionDescription & option : command.options)
    {
      const Candidates  kind = CandidatesOf(option);
      const std::string values = kind == Candidates::Files     ? "FILES"
                                 : kind == Candidates::Choices ? Choices(option)
                                                               : "NONE";
      for (const std::string & name : option.names)
      {
        words << ' ' << name;
        if (!option.flag)
        {
          std::string & pattern = patterns[values];
          pattern += (pattern.empty() ? "\" " : " | \" ") + command.name + ' ' + name + '"';
        }
      }
    }
    words << "\" ;;\n";
  }
  std::ostringstream text;
  text << Replace(bashHead, "COMMANDS", names);
  for (const auto & [values, pattern] : patterns)
  {
    text << "    " << pattern << ") values=\"" << values << "\" ;;\n";
  }
  text << "  esac\n  local only=\"\"\n  case $command in\n    \"\") only=yes words=\"" << WordsOf(EntriesOf(commands))
       << " --help --version\" ;;\n";
  for (const auto & group : groups)
  {
    text << "    \" " << group.first << "\") only=yes words=\"" << WordsOf(EntriesOf(commands, group.first))
         << " --help\" ;;\n";
  }
  text << words.str() << bashTail;
  return text.str();
}

namespace
{
/** "_bonetk_register_rigid" */
std::string
ZshFunction(const std::string & command)
{
  return "_bonetk_" + Replace(command, " ", "_");
}

std::string
ZshAction(const OptionDescription & option)
{
  const Candidates kind = CandidatesOf(option);
  return kind == Candidates::Choices ? '(' + Choices(option) + ')' : kind == Candidates::Files ? "_files" : " ";
}

/** A function that completes one of several words and goes on in that word's own function. */
std::string
ZshChoice(const std::string & name, const std::vector<Entry> & entries, const std::string & before)
{
  std::ostringstream text;
  text << name << "()\n{\n  local -a entries\n  entries=(\n";
  for (const Entry & entry : entries)
  {
    text << "    " << Quoted(entry.word + ':' + Replace(entry.help, ":", "\\:")) << '\n';
  }
  text << "  )\n  local context state line\n  typeset -A opt_args\n"
       << "  _arguments -C '(- *)'{-h,--help}'[Print the options and exit]' "
       << (before.empty() ? "'(- *)--version[Print version, commit, compiler and libraries, and exit]' " : "")
       << "'1:command:->command' '*::argument:->rest'\n"
       << "  case $state in\n    command) _describe command entries ;;\n    rest) (( $+functions["
       << ZshFunction(before) << "$words[1]] )) && " << ZshFunction(before) << "$words[1] ;;\n  esac\n}\n\n";
  return text.str();
}
} // namespace

std::string
MakeZshCompletion(const std::vector<CommandDescription> & commands)
{
  std::ostringstream text;
  text << "#compdef bonetk\n# Completion of bonetk in zsh. Made from the program's options: do not edit.\n\n"
       << ZshChoice("_bonetk", EntriesOf(commands), "");
  for (const auto & group : GroupsOf(commands))
  {
    text << ZshChoice(ZshFunction(group.first), EntriesOf(commands, group.first), group.first + ' ');
  }
  for (const CommandDescription & command : commands)
  {
    text << ZshFunction(command.name) << "()\n{\n  _arguments -s";
    for (const OptionDescription & option : command.options)
    {
      const std::string help = Replace(Replace(option.help, "[", "\\["), "]", "\\]");
      const std::string value = option.flag ? "" : ':' + Replace(option.type, ":", "\\:") + ':' + ZshAction(option);
      if (option.positional)
      {
        text << " \\\n    " << Quoted((option.most == 1 ? ":" : "*:") + option.name + ':' + ZshAction(option));
      }
      for (const std::string & name : option.names)
      {
        text << " \\\n    " << Quoted((option.most == 1 ? "" : "*") + name + '[' + help + ']' + value);
      }
    }
    text << "\n}\n\n";
  }
  text << "_bonetk \"$@\"\n";
  return text.str();
}

std::string
MakeFishCompletion(const std::vector<CommandDescription> & commands)
{
  const auto  groups = GroupsOf(commands);
  std::string names;
  for (const auto & group : groups)
  {
    names += ' ' + group.first;
  }
  // A backslash and a quote are escaped within single quotes in fish.
  const auto quoted = [](const std::string & text) {
    return '\'' + Replace(Replace(text, "\\", "\\\\"), "'", "\\'") + '\'';
  };
  const auto at = [&quoted](const std::string & command) { return "-n " + quoted("__bonetk_at '" + command + "'"); };
  std::ostringstream text;
  text << "# Completion of bonetk in fish. Made from the program's options: do not edit.\n"
       << "function __bonetk_at -d 'Whether the command so far is this'\n"
       << "  set -l words (commandline -opc)\n"
       << "  set -l command \"$words[2]\"\n"
       << "  if contains -- \"$command\"" << names << "\n    set command (string trim \"$command $words[3]\")\n  end\n"
       << "  test \"$command\" = \"$argv[1]\"\nend\n\n"
       << "complete -c bonetk -f\n"
       << "complete -c bonetk " << at("")
       << " -l version -d 'Print version, commit, compiler and libraries, and exit'\n"
       << "complete -c bonetk " << at("") << " -s h -l help -d 'Print the commands and exit'\n";
  for (const Entry & entry : EntriesOf(commands))
  {
    text << "complete -c bonetk " << at("") << " -a " << entry.word << " -d " << quoted(entry.help) << '\n';
  }
  for (const auto & group : groups)
  {
    for (const Entry & entry : EntriesOf(commands, group.first))
    {
      text << "complete -c bonetk " << at(group.first) << " -a " << entry.word << " -d " << quoted(entry.help) << '\n';
    }
  }
  for (const CommandDescription & command : commands)
  {
    for (const OptionDescription & option : command.options)
    {
      if (option.positional)
      {
        text << "complete -c bonetk " << at(command.name) << " -F\n";
      }
      if (option.names.empty())
      {
        continue;
      }
      text << "complete -c bonetk " << at(command.name);
      for (const std::string & name : option.names)
      {
        text << (name[1] == '-' ? " -l " + name.substr(2) : " -s " + name.substr(1));
      }
      const Candidates kind = CandidatesOf(option);
      if (!option.flag)
      {
        text << (kind == Candidates::Choices ? " -x -a " + quoted(Choices(option))
                 : kind == Candidates::Files ? " -r -F"
                                             : " -x");
      }
      text << " -d " << quoted(option.help) << '\n';
    }
  }
  return text.str();
}
} // namespace bone
