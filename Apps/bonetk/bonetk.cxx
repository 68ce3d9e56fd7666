/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneIOError.h"
#include "boneOptions.h"
#include "boneOutputTransaction.h"
#include "boneSignals.h"

#include <itkMultiThreaderBase.h>

#include <algorithm>
#include <numeric>
#include <sstream>

namespace
{
enum ExitCode
{
  Success = 0,
  BadData = 1,
  BadUsage = 2
};

void
AddSharedOptions(CLI::App & app, bone::Session & session)
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
JoinArguments(int argc, char ** argv)
{
  std::string line;
  for (int i = 0; i < argc; ++i)
  {
    const std::string word = i == 0 ? "bonetk" : argv[i];
    const bool        plain = !word.empty() && word.find_first_of(" \t\n'\"\\$&|;<>()*?[]#~`") == std::string::npos;
    line += (i == 0 ? "" : " ") + (plain ? word : "'" + word + "'");
  }
  return line;
}

/** Parses the command line. Returns true where there is something to do and sets what its options say to write, else
 * sets the exit code. */
bool
Parse(CLI::App &                 app,
      int                        argc,
      char **                    argv,
      bone::Session &            session,
      std::vector<std::string> & outputs,
      int &                      exitCode)
{
  try
  {
    app.parse(argc, argv);
    session.command = NameOfChosen(app);
    session.inputs = bone::FindInputs(ChosenCommand(app));
    outputs = bone::FindOutputs(ChosenCommand(app));
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
    session.command = NameOfChosen(app);
    const std::string nearest = session.command.empty() && argc > 1 ? NearestCommand(app, argv[1]) : "";
    if (!nearest.empty())
    {
      session.Fail(std::string("there is no command ") + argv[1] + "; did you mean " + nearest + "?");
      exitCode = BadUsage;
      return false;
    }
    const std::string name = session.command.empty() ? "bonetk" : "bonetk " + session.command;
    session.Fail(std::string(error.what()) + "; see " + name + " --help");
    exitCode = BadUsage;
    return false;
  }
}

/** Does the work: its outputs appear together or not at all. `names` are those that its options say. */
int
Run(const bone::Action & action, const std::vector<std::string> & names, bone::Session & session)
{
  try
  {
    bone::VerifyStatusFile(session.status, names);
    session.Start();
    bone::OutputTransaction outputs;
    action(session);
    outputs.Commit();
    session.Finish();
    return Success;
  }
  catch (const bone::UsageError & error)
  {
    session.Fail(std::string(error.what()) + "; see bonetk " + session.command + " --help");
    return BadUsage;
  }
  catch (const std::exception & error)
  {
    session.Fail(error);
  }
  catch (...)
  {
    session.Fail("failed in an unknown way; please report it with its input");
  }
  return BadData;
}
} // namespace

int
main(int argc, char ** argv)
{
  bone::InstallSignalHandling();
  bone::Session         session;
  bone::Action          action;
  const bone::LastWords last(
    [&session](int exitCode, const std::string & reason) { return session.Interrupt(exitCode, reason); });
  session.version = BONETK_VERSION;
  session.commandLine = JoinArguments(argc, argv);

  CLI::App app(
    "BoneTK: layered tetrahedral density models of bones from CT. Exit codes: 0 done, 1 bad data, 2 bad usage.",
    "bonetk");
  app.require_subcommand(1);
  app.set_version_flag("--version", "bonetk " BONETK_VERSION);
  bone::AddPhantomCommand(app, action);
  bone::AddCropCommand(app, action);
  bone::AddContoursCommand(app, action);
  bone::AddMeshCommand(app, action);
  bone::AddSmoothCommand(app, action);
  bone::AddFitCommand(app, action);
  bone::AddCalibrateCommand(app, action);
  bone::AddVoxelsCommand(app, action);
  bone::AddProfileCommand(app, action);
  bone::AddSimplifyCommand(app, action);
  bone::AddBuildCommand(app, action);
  bone::AddDrrCommand(app, action);
  bone::AddTrainCommand(app, action);
  bone::AddSampleCommand(app, action);
  bone::AddRegisterCommand(app, action);
  bone::AddLabelCommand(app, action);
  bone::AddEvaluateCommand(app, action);
  bone::AddMeasureCommand(app, action);
  bone::AddPlanCommand(app, action);
  bone::AddExportCommand(app, action);
  bone::AddValidateCommand(app, action);
  bone::AddInfoCommand(app, action);
  AddSharedOptions(app, session);
  bone::ReadDecimalNumbers(app);

  int                      exitCode = Success;
  std::vector<std::string> outputs;
  if (!Parse(app, argc, argv, session, outputs, exitCode))
  {
    return exitCode;
  }
  if (session.threads > 0)
  {
    itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(static_cast<itk::ThreadIdType>(session.threads));
    itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(static_cast<itk::ThreadIdType>(session.threads));
  }
  exitCode = session.End(Run(action, outputs, session));
  bone::OutputTransaction::FinishAll();
  return exitCode;
}
