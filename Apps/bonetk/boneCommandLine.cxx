/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommandLine.h"

#include "boneBuildInformation.h"
#include "boneCommands.h"
#include "boneIOError.h"
#include "boneOptions.h"
#include "boneOutputTransaction.h"

#include <itkMultiThreaderBase.h>

#include <algorithm>
#include <numeric>
#include <sstream>

namespace bone
{
namespace
{
enum ExitCode
{
  Success = 0,
  BadData = 1,
  BadUsage = 2,
  MachineFailed = 3
};

void
AddSharedOptions(CLI::App & app, Session & session)
{
  for (CLI::App * command : app.get_subcommands([](const CLI::App *) { return true; }))
  {
    if (!command->get_subcommands([](const CLI::App *) { return true; }).empty())
    {
      AddSharedOptions(*command, session); // of the commands in a group
      continue;
    }
    command->add_flag(
      "-q,--quiet", session.quiet, "Print errors, and warnings that the result is not what was asked for, alone");
    command->add_flag("--verbose", session.verbose, "Print how long each stage took")->excludes("--quiet");
    command
      ->add_option("--status",
                   session.status,
                   "Write progress for programs while the work goes: JSON lines in a file, a named pipe or /dev/fd/N")
      ->type_name("FILE");
    command
      ->add_option("--threads", session.threads, "Number of threads; default: all processors. Does not change results")
      ->check(CLI::Range(1, 1024).description(""));
  }
}

/** Letters to change, add or leave out to make one word of the other. */
std::size_t
EditDistance(const std::string & a, const std::string & b)
{
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{ 0 });
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j)
    {
      const std::size_t change = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({ change, row[j] + 1, row[j + 1] + 1 });
    }
  }
  return row.back();
}

/** The command that a mistyped word is nearest to; empty where none is near. */
std::string
NearestCommand(const CLI::App & app, const std::string & word)
{
  std::string nearest;
  std::size_t least = 3;
  for (const CLI::App * command : app.get_subcommands([](const CLI::App *) { return true; }))
  {
    const std::size_t distance = EditDistance(word, command->get_name());
    if (distance > 0 && distance < least)
    {
      least = distance;
      nearest = command->get_name();
    }
  }
  return nearest;
}

/** What was called, as far as it was parsed: the command, of a group the one in it. */
const CLI::App &
ChosenCommand(const CLI::App & app)
{
  const CLI::App * command = &app;
  while (!command->get_subcommands().empty())
  {
    command = command->get_subcommands().front();
  }
  return *command;
}

/** "drr", "register rigid"; empty where no command was called. */
std::string
NameOfChosen(const CLI::App & app)
{
  std::string name;
  for (const CLI::App * command = &ChosenCommand(app); command != &app; command = command->get_parent())
  {
    name = command->get_name() + (name.empty() ? "" : " ") + name;
  }
  return name;
}

/** The words of a command line, with quotes about those that a shell would take apart. */
std::string
JoinWords(const std::vector<std::string> & words)
{
  std::string line = "bonetk";
  for (const std::string & word : words)
  {
    const bool plain = !word.empty() && word.find_first_of(" \t\n'\"\\$&|;<>()*?[]#~`") == std::string::npos;
    line += " " + (plain ? word : "'" + word + "'");
  }
  return line;
}

/** Parses the command line. Returns true where there is something to do and sets what its options say to write, else
 * sets the exit code. */
bool
Parse(CLI::App &                       app,
      const std::vector<std::string> & words,
      Session &                        session,
      std::vector<std::string> &       outputs,
      int &                            exitCode)
{
  try
  {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    session.command = NameOfChosen(app);
    session.inputs = FindInputs(ChosenCommand(app));
    outputs = FindOutputs(ChosenCommand(app));
    return true;
  }
  catch (const CLI::ParseError & error)
  {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success))
    {
      std::ostringstream text;
      app.exit(error, text, text); // writes what --help or --version asked for
      session.PrintAlways(text.str());
      exitCode = Success;
      return false;
    }
    exitCode = BadUsage;
    session.command = NameOfChosen(app);
    const std::string nearest = session.command.empty() && !words.empty() ? NearestCommand(app, words[0]) : "";
    if (!nearest.empty())
    {
      session.Fail("there is no command " + words[0] + "; did you mean " + nearest + "?");
      return false;
    }
    const std::string name = session.command.empty() ? "bonetk" : "bonetk " + session.command;
    session.Fail(std::string(error.what()) + "; see " + name + " --help");
    return false;
  }
}

/** Does the work: its outputs appear together or not at all. `names` are those that its options say. */
int
Run(const Action & action, const std::vector<std::string> & names, Session & session)
{
  try
  {
    VerifyStatusFile(session.status, names);
    session.Start();
    OutputTransaction outputs;
    action(session);
    if (session.IsStopRequested())
    {
      throw itk::ProcessAborted(__FILE__, __LINE__);
    }
    outputs.Commit();
    session.outputs = outputs.GetCommitted();
    session.outputs.insert(session.outputs.end(), session.kept.begin(), session.kept.end());
    session.Finish();
    return Success;
  }
  catch (const UsageError & error)
  {
    session.Fail(std::string(error.what()) + "; see bonetk " + session.command + " --help");
    return BadUsage;
  }
  catch (const std::exception & error)
  {
    session.Fail(error);
    return IsOfTheMachine(error) ? MachineFailed : BadData;
  }
  catch (...)
  {
    session.Fail("failed in an unknown way; please report it with its input");
  }
  return BadData;
}

/** ITK's number of threads while it lives; 0: as it is. */
class ThreadsScope
{
public:
  using Threader = itk::MultiThreaderBase;

  explicit ThreadsScope(int threads)
  {
    if (threads > 0)
    {
      Threader::SetGlobalMaximumNumberOfThreads(static_cast<itk::ThreadIdType>(threads));
      Threader::SetGlobalDefaultNumberOfThreads(static_cast<itk::ThreadIdType>(threads));
    }
  }
  ~ThreadsScope()
  {
    Threader::SetGlobalMaximumNumberOfThreads(m_Maximum);
    Threader::SetGlobalDefaultNumberOfThreads(m_Default);
  }
  ThreadsScope(const ThreadsScope &) = delete;
  ThreadsScope &
  operator=(const ThreadsScope &) = delete;

private:
  itk::ThreadIdType m_Maximum{ Threader::GetGlobalMaximumNumberOfThreads() };
  itk::ThreadIdType m_Default{ Threader::GetGlobalDefaultNumberOfThreads() };
};
} // namespace

void
AddCommands(CLI::App & app, Action & action, Session & session)
{
  app.require_subcommand(1);
  app.set_version_flag("--version", DescribeBuild(), "Print version, commit, compiler and libraries, and exit");
  AddPhantomCommand(app, action);
  AddCropCommand(app, action);
  AddContoursCommand(app, action);
  AddMeshCommand(app, action);
  AddSmoothCommand(app, action);
  AddFitCommand(app, action);
  AddCalibrateCommand(app, action);
  AddVoxelsCommand(app, action);
  AddProfileCommand(app, action);
  AddSimplifyCommand(app, action);
  AddBuildCommand(app, action);
  AddDrrCommand(app, action);
  AddTrainCommand(app, action);
  AddSampleCommand(app, action);
  AddRegisterCommand(app, action);
  AddLabelCommand(app, action);
  AddEvaluateCommand(app, action);
  AddMeasureCommand(app, action);
  AddThicknessCommand(app, action);
  AddPlanCommand(app, action);
  AddExportCommand(app, action);
  AddValidateCommand(app, action);
  AddInfoCommand(app, action);
  AddSharedOptions(app, session);
  ReadDecimalNumbers(app);
}

std::string
DescribeProgram()
{
  return "BoneTK: layered tetrahedral density models of bones from CT. Exit codes: 0 done, 1 bad data, 2 bad usage, "
         "3 no space on the disk or no memory, 128 and n ended by signal n.";
}

int
RunCommandLine(const std::vector<std::string> & words, Session & session)
{
  session.version = GetBuildInformation().version;
  session.commandLine = JoinWords(words);
  CLI::App app(DescribeProgram(), "bonetk");
  Action   action;
  AddCommands(app, action, session);
  int                      exitCode = Success;
  std::vector<std::string> outputs;
  if (!Parse(app, words, session, outputs, exitCode))
  {
    return exitCode;
  }
  const ThreadsScope threads(session.threads);
  return session.End(Run(action, outputs, session));
}
} // namespace bone
