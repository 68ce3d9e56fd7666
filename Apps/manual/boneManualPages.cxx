/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneManualPages.h"

#include "boneBuildInformation.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace bone
{
namespace
{
/** Text as roff reads it. The dashes of options are minus signs, which can be copied into a shell. */
std::string
Roff(const std::string & text)
{
  std::string        roff;
  std::string        line;
  std::istringstream words(text);
  for (std::string word; words >> word;)
  {
    const std::size_t begin = word.find_first_not_of("(\"'");
    const bool        option = begin != std::string::npos && word[begin] == '-';
    std::string       escaped;
    for (const char c : word)
    {
      escaped += c == '\\' ? "\\e" : c == '-' && option ? "\\-" : c == '\'' ? "\\(aq" : std::string(1, c);
    }
    if (line.size() + escaped.size() > 78)
    {
      roff += line + '\n';
      line.clear();
    }
    // A dot at a line's beginning would be a macro's.
    line += (line.empty() ? (escaped[0] == '.' ? "\\&" : "") : " ") + escaped;
  }
  return roff + line;
}

std::string
Bold(const std::string & text)
{
  return "\\fB" + Roff(text) + "\\fR";
}

std::string
Italic(const std::string & text)
{
  return "\\fI" + Roff(text) + "\\fR";
}

/** "bonetk-register-rigid" */
std::string
PageName(const CommandDescription & command)
{
  std::string name = "bonetk-" + command.name;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

/** The first sentence, without its full stop. */
std::string
FirstSentence(const std::string & text)
{
  const std::string sentence = text.substr(0, text.find(". "));
  return sentence.back() == '.' ? sentence.substr(0, sentence.size() - 1) : sentence;
}

/** Text with a full stop. */
std::string
Sentence(const std::string & text)
{
  return text.empty() || text.back() == '.' ? text : text + '.';
}

std::string
Head(const std::string & name, const std::string & summary)
{
  const BuildInformation & build = GetBuildInformation();
  std::string              title = name;
  std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return std::toupper(c); });
  std::ostringstream page;
  page << ".\\\" Made from the program's options: do not edit.\n"
       << ".TH \"" << title << "\" 1 \"" << build.date << "\" \"BoneTK " << build.version << "\" \"BoneTK\"\n"
       << ".SH NAME\n"
       << name << " \\- " << Roff(summary) << '\n';
  return page.str();
}

/** The values of an option or at a place: "TEXT", "NUMBER ...". */
std::string
Values(const OptionDescription & option)
{
  const std::string value = option.positional ? option.name : option.type;
  const bool        several = option.most != 1 && value.find("...") == std::string::npos;
  return option.flag ? "" : Italic(value + (several ? " ..." : ""));
}

std::string
Synopsis(const CommandDescription & command)
{
  std::ostringstream text;
  text << ".SH SYNOPSIS\n" << Bold("bonetk " + command.name);
  for (const OptionDescription & option : command.options)
  {
    if (option.positional)
    {
      text << '\n' << (option.required ? Values(option) : '[' + Values(option) + ']');
    }
    else if (option.required)
    {
      text << '\n' << Bold(option.names.front()) << ' ' << Values(option);
    }
  }
  text << "\n[" << Italic("options") << "]\n";
  return text.str();
}

std::string
Options(const CommandDescription & command)
{
  std::ostringstream text;
  for (const bool positional : { true, false })
  {
    bool first = true;
    for (const OptionDescription & option : command.options)
    {
      if (option.positional != positional)
      {
        continue;
      }
      text << (first ? positional ? ".SH ARGUMENTS\n" : ".SH OPTIONS\n" : "") << ".TP\n";
      first = false;
      text << (positional ? Values(option) : "");
      for (const std::string & name : option.names)
      {
        text << (!positional && name == option.names.front() ? "" : ", ") << Bold(name);
      }
      text << (positional || option.flag ? "" : " " + Values(option)) << '\n'
           << Roff(Sentence(option.help) + (option.required ? " Required." : "")) << '\n';
    }
  }
  return text.str();
}

std::string
ExitStatus()
{
  std::ostringstream text;
  text << ".SH EXIT STATUS\n";
  for (const auto & [code, meaning] :
       { std::pair<const char *, const char *>{ "0", "Done; the outputs are there, all of them." },
         { "1", "Bad data, or a file that cannot be read or written. No output is written." },
         { "2", "Bad usage. Nothing was done." },
         { "128 + n", "Ended by the signal n. No output is written." } })
  {
    text << ".TP\n" << code << '\n' << meaning << '\n';
  }
  return text.str();
}

TextFile
CommandPage(const CommandDescription & command)
{
  std::ostringstream page;
  page << Head(PageName(command), FirstSentence(command.help)) << Synopsis(command) << ".SH DESCRIPTION\n"
       << Roff(Sentence(command.help)) << '\n'
       << Options(command) << ExitStatus() << ".SH SEE ALSO\n.BR bonetk (1)\n";
  return { PageName(command) + ".1", page.str() };
}

TextFile
ProgramPage(const std::vector<CommandDescription> & commands)
{
  std::ostringstream page;
  page << Head("bonetk", "layered tetrahedral density models of bones from CT")
       << ".SH SYNOPSIS\n.B bonetk\n\\fIcommand\\fR [\\fIoptions\\fR]\n.br\n.B bonetk\n\\fIcommand\\fR "
          "\\fB\\-\\-help\\fR\n"
       << ".br\n.B bonetk \\-\\-version\n"
       << ".SH DESCRIPTION\n"
       << Roff(DescribeProgram()) << "\n.PP\n"
       << "Each command has a page of its own:\n.BR \"man bonetk build\" .\n"
       << "Lengths are in mm and coordinates in LPS, the patient's left, posterior and superior.\n"
       << ".SH COMMANDS\n";
  for (const CommandDescription & command : commands)
  {
    page << ".TP\n" << Bold(command.name) << '\n' << Roff(Sentence(FirstSentence(command.help))) << '\n';
  }
  page << ".SH EXAMPLES\nA model of an analytic femur, and a page that shows it:\n.PP\n.nf\n"
       << "bonetk phantom \\-\\-spacing 1 \\-o ct.nii.gz \\-\\-labels labels.nii.gz\n"
       << "bonetk build ct.nii.gz \\-\\-labels labels.nii.gz \\-o femur\n.fi\n"
       << ExitStatus() << ".SH SEE ALSO\n";
  for (const CommandDescription & command : commands)
  {
    page << ".BR " << PageName(command) << (&command == &commands.back() ? " (1)\n" : " (1),\n");
  }
  return { "bonetk.1", page.str() };
}
} // namespace

std::vector<TextFile>
MakeManualPages(const std::vector<CommandDescription> & commands)
{
  std::vector<TextFile> pages{ ProgramPage(commands) };
  std::transform(commands.begin(), commands.end(), std::back_inserter(pages), CommandPage);
  return pages;
}
} // namespace bone
