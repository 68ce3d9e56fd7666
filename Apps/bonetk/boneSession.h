/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSession_h
#define boneSession_h

#include <itkProcessObject.h>

#include <chrono>
#include <exception>
#include <mutex>
#include <string>
#include <vector>

namespace bone
{
/** \class Session
 * \brief One run of a command: where its text goes, and what it warned of.
 *
 * Results go to standard output, warnings and progress to standard error; with `quiet` there are none of them, only
 * errors and warnings that the result is not what was asked for. Warnings of ITK filters become lines of this session
 * too. What the libraries below ITK print by themselves reaches nobody: while a session lives, only it has the
 * process's standard streams. */
class Session
{
public:
  Session();
  ~Session();
  Session(const Session &) = delete;
  Session &
  operator=(const Session &) = delete;

  /** \name Options that all commands share
   * \{ */
  bool quiet{ false };
  int  threads{ 0 }; ///< 0: all processors
  /** \} */
  std::string              command;
  std::vector<std::string> inputs;  ///< files that the command line names
  std::string              subject; ///< of several that the command works on; warnings and errors name it

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

  /** To be called at the end. Throws std::runtime_error where text for standard output was lost, as on a full disk. One
   * that nobody reads any more is no error: they have seen what they wanted. */
  void
  Finish() const;

  const std::vector<std::string> &
  GetWarnings() const
  {
    return m_Warnings;
  }

  /** Forgets all warnings but the first `count`. */
  void
  ForgetWarnings(std::size_t count);

  /** Shows the filter's progress on a terminal while it runs, from the first second of the command on. */
  void
  Watch(itk::ProcessObject * filter, const std::string & name);

private:
  void
  WriteError(const std::string & text);
  /** "bonetk COMMAND: SUBJECT: " */
  std::string
  Heading() const;
  void
  Warn(const std::string & message, bool shown);
  void
  ShowProgress(const std::string & name, double share);
  void
  ClearProgress();

  std::vector<std::string>              m_Warnings;
  std::mutex                            m_Mutex;
  std::chrono::steady_clock::time_point m_Start;
  int                                   m_Output; ///< where standard output went
  int                                   m_Error;
  bool                                  m_Terminal;
  std::string                           m_Shown;
  int                                   m_PrintError{ 0 }; ///< of errno
};

/** A usage error found after parsing: exit code 2. */
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};
} // namespace bone

#endif
