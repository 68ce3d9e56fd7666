/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSession_h
#define boneSession_h

#include "boneProgress.h"
#include "boneStatusFile.h"

#include <itkOutputWindow.h>
#include <itkProcessObject.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace bone
{
/** Where a session's text goes: to the process's standard streams, which are then its own, or into strings, which
 * leaves the process as it is. */
enum class SessionStreams
{
  Process,
  Captured
};

/** \class Session
 * \brief One run of a command: where its text goes, how far it is, and what it warned of.
 *
 * Results go to standard output, warnings and progress to standard error; with `quiet` there are none of them, only
 * errors and warnings that the result is not what was asked for. Warnings of ITK filters become lines of this session
 * too. What the libraries below ITK print by themselves reaches nobody: while a session lives, only it has the
 * process's standard streams. A session whose text is captured is for programs that call a command as a function: it
 * touches no stream, and another thread may ask how far it is and stop it.
 *
 * Progress is known by stages: filters that are watched, and scopes of BeginStage(). From the first second on a
 * terminal shows stage, share and time left; with `verbose` a line tells how long each stage took; `status` names a
 * file of JSON lines for programs (Documentation/formats.md). A thread of its own writes them, five times a second at
 * most, so that no stage waits for a reader. */
class Session
{
public:
  explicit Session(SessionStreams streams = SessionStreams::Process);
  ~Session();
  Session(const Session &) = delete;
  Session &
  operator=(const Session &) = delete;

  /** \name Options that all commands share
   * \{ */
  bool        quiet{ false };
  bool        verbose{ false };
  int         threads{ 0 }; ///< 0: all processors
  std::string status;       ///< file for programs; empty: none
  /** \} */
  std::string              command;
  std::string              commandLine; ///< as it was called
  std::string              version;
  std::vector<std::string> inputs;  ///< files that the command line names
  std::vector<std::string> outputs; ///< files and folders that were written, see OutputTransaction::GetCommitted()
  std::vector<std::string> kept;    ///< those of an earlier run that are as they would be written
  std::string              subject; ///< of several that the command works on; warnings and errors name it

  /** To be called before the work: opens the status file and writes its first line. Throws UsageError where it cannot
   * be written. */
  void
  Start();

  /** To be called after the work: writes the status file's last line. The first exit code that End() or Interrupt() is
   * told is the process's; it is returned. */
  int
  End(int exitCode);

  /** The same for a thread that waits for signals and ends the process: waits for nobody. */
  int
  Interrupt(int exitCode, const std::string & reason);

  /** Text for standard output. */
  void
  Print(const std::string & text);

  /** One line on standard error: "bonetk COMMAND: warning: message". Each message once. */
  void
  Warn(const std::string & message);

  /** The same, quiet or not: the result is not what was asked for. */
  void
  WarnAlways(const std::string & message);

  /** "bonetk COMMAND: message" on standard error, quiet or not. */
  void
  Fail(const std::string & message);

  /** The same for an error. The stages do not know files: what names none of the inputs gets their names put before it.
   */
  void
  Fail(const std::exception & error);

  /** What --help or --version asked for, quiet or not. */
  void
  PrintAlways(const std::string & text);

  /** To be called at the end. Throws IOError where text for standard output or the status file was lost, as on a full
   * disk. One that nobody reads any more is no error: they have seen what they wanted. */
  void
  Finish() const;

  const std::vector<std::string> &
  GetWarnings() const
  {
    return m_Warnings;
  }

  /** \name For the thread that calls a command whose text is captured. Any thread may call them at any time.
   * \{ */
  /** What was printed for standard output. */
  std::string
  GetPrinted() const;
  /** Lines for standard error: warnings that are shown, seconds of stages, errors. */
  std::string
  GetMessages() const;
  /** All warnings, with their subjects; none is forgotten. */
  std::vector<std::string>
  GetAllWarnings() const;
  /** The last error without "bonetk COMMAND: "; empty where there is none. */
  std::string
  GetFailure() const;

  /** How far the command is. */
  struct Position
  {
    std::string stage; ///< "SUBJECT: STAGE", empty before the first and between stages
    double      share; ///< 0 to 1; never falls
  };
  Position
  GetPosition() const;

  /** The work ends with itk::ProcessAborted, at the latest when the present stage ends; filters that are watched end at
   * once. To be called again until the work has ended: a filter that just starts forgets that it was asked. */
  void
  RequestStop();
  /** \} */

  bool
  IsStopRequested() const
  {
    return m_StopRequested;
  }

  /** Forgets all warnings but the first `count`. */
  void
  ForgetWarnings(std::size_t count);

  /** The stages to come, see Progress::Expect. Without it a watched filter's progress is the command's. */
  void
  Expect(const std::vector<ExpectedStage> & stages, double from = 0.0, double to = 1.0);

  /** Makes each run of the filter a stage, as long as this session lives. */
  void
  Watch(itk::ProcessObject * filter, const std::string & name);

  /** A run of a stage, from BeginStage() to the end of its scope. */
  class Stage
  {
  public:
    Stage(Session & session, const std::string & name);
    ~Stage();
    Stage(const Stage &) = delete;
    Stage &
    operator=(const Stage &) = delete;

  private:
    Session & m_Session;
    int       m_Run;
    int       m_Exceptions;
  };

  /** `const auto stage = session.BeginStage("reading");`: what is done until `stage` goes out of scope is that stage.
   */
  Stage
  BeginStage(const std::string & name)
  {
    return { *this, name };
  }

private:
  /** What the status file was told last. */
  struct Shown
  {
    std::string stage{ "start" };
    std::string subject;
    double      share{ 0.0 };
    std::size_t warnings{ 0 };
  };

  bool
  ShowsProgress() const
  {
    return m_Terminal && !quiet;
  }
  void
  WriteOutput(const std::string & text);
  void
  WriteError(const std::string & text);
  void
  ThrowIfStopped() const;
  /** A line on standard error, in place of the progress. */
  void
  WriteLine(const std::string & line);
  /** "bonetk COMMAND: SUBJECT: " */
  std::string
  Heading() const;
  void
  Warn(const std::string & message, bool shown);
  int
  BeginRun(const std::string & name);
  void
  EndRun(int run);
  void
  Tick();
  void
  ShowProgress();
  void
  ClearProgress();
  double
  Seconds() const;
  /** The status file's line of now with the warnings from `first` on, and with `more` members; m_Mutex is held, or
   * nobody else writes any more. */
  std::string
  StatusLine(const std::string & stage, std::size_t first, const nlohmann::ordered_json & more) const;
  std::string
  EndLine(int exitCode) const;

  const bool                  m_Captured;
  Progress::Clock::time_point m_Start;
  int                         m_Output; ///< where standard output went
  int                         m_Error;
  bool                        m_Terminal;
  itk::OutputWindow::Pointer  m_Window;          ///< ITK's before this session's
  int                         m_PrintError{ 0 }; ///< of errno

  mutable std::timed_mutex                   m_Mutex; ///< of the work's state; never held while something is written
  Progress                                   m_Progress;
  std::vector<std::string>                   m_Warnings;
  std::vector<std::string>                   m_AllWarnings; ///< of the status file: with subjects, none forgotten
  std::string                                m_Failure;     ///< the last one
  std::string                                m_Subject;     ///< as the status file tells it
  std::atomic<bool>                          m_StopRequested{ false };
  std::map<int, itk::ProcessObject::Pointer> m_Running; ///< filters that are watched, by their runs

  mutable std::mutex m_ErrorMutex; ///< of standard output and error
  std::string        m_ProgressLine;
  std::string        m_Printed;  ///< where captured
  std::string        m_Messages; ///< the same

  std::unique_ptr<StatusFile> m_StatusFile;
  Shown                       m_Told;
  std::atomic<int>            m_Exit{ -1 };
  std::thread                 m_Ticker;
  std::mutex                  m_TickerMutex;
  std::condition_variable     m_TickerStop;
  bool                        m_Stopping{ false };
};

/** A usage error found after parsing: exit code 2. */
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/** Whether another try may do: MachineError, no memory, or no thread to be had. */
bool
IsOfTheMachine(const std::exception & error);
} // namespace bone

#endif
