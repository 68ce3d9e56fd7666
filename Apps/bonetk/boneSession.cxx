/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSession.h"

#include "boneIOError.h"

#include <itkCommand.h>
#include <itkOutputWindow.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>
#include <regex>
#include <system_error>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace bone
{
namespace
{
/** Turns what ITK's filters warn of, several lines with addresses and places in the source, into lines of the session.
 */
class SessionWindow : public itk::OutputWindow
{
public:
  using Self = SessionWindow;
  using Superclass = itk::OutputWindow;
  using Pointer = itk::SmartPointer<Self>;
  itkNewMacro(Self);
  itkTypeMacro(SessionWindow, itk::OutputWindow);

  void
  SetSession(Session * session)
  {
    m_Session = session;
  }
  void
  DisplayText(const char * text) override
  {
    static const std::regex header(R"(^\s*(WARNING|ERROR|Debug): In [^\n]*\n)");
    static const std::regex object(R"(^\w+ ?\((0x)?[0-9a-f]+\): )");
    static const std::regex space(R"(\s+)");
    std::string             line = std::regex_replace(std::string(text), header, "");
    line = std::regex_replace(line, object, "");
    line = std::regex_replace(line, space, " ");
    line.erase(line.find_last_not_of(' ') + 1);
    if (m_Session != nullptr && !line.empty())
    {
      m_Session->Warn(line);
    }
  }

private:
  Session * m_Session{ nullptr };
};

/** Out of the way of the descriptors that a shell gives its programs. */
int
Duplicate(int file)
{
  constexpr int first = 100;
  const int     copy = fcntl(file, F_DUPFD_CLOEXEC, first);
  return copy >= 0 ? copy : fcntl(file, F_DUPFD_CLOEXEC, 0);
}

/** "about 12 s left" */
std::string
TimeLeft(double seconds)
{
  return "about " +
         (seconds < 90.0 ? std::to_string(std::max(1L, std::lround(seconds))) + " s"
                         : std::to_string(std::lround(seconds / 60.0)) + " min") +
         " left";
}

bool
IsOfMemory(const std::exception & error)
{
  return dynamic_cast<const std::bad_alloc *>(&error) != nullptr ||
         dynamic_cast<const itk::MemoryAllocationError *>(&error) != nullptr;
}

/** Columns of the terminal. */
std::size_t
WidthOf(int terminal)
{
  winsize size{};
  return ioctl(terminal, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}
} // namespace

bool
IsOfTheMachine(const std::exception & error)
{
  // A thread that cannot be started, as with a limit on processes.
  const auto * ofSystem = dynamic_cast<const std::system_error *>(&error);
  return IsOfMemory(error) || dynamic_cast<const MachineError *>(&error) != nullptr ||
         (ofSystem != nullptr && ofSystem->code() == std::errc::resource_unavailable_try_again);
}

Session::Session(SessionStreams streams)
  : m_Captured(streams == SessionStreams::Captured)
  , m_Start(Progress::Clock::now())
  , m_Output(m_Captured ? STDOUT_FILENO : Duplicate(STDOUT_FILENO))
  , m_Error(m_Captured ? STDERR_FILENO : Duplicate(STDERR_FILENO))
  , m_Terminal(!m_Captured && isatty(STDERR_FILENO) == 1)
  , m_Window(itk::OutputWindow::GetInstance())
{
  if (!m_Captured)
  {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    close(nowhere);
  }
  auto window = SessionWindow::New();
  window->SetSession(this);
  itk::OutputWindow::SetInstance(window);
}

Session::~Session()
{
  this->End(m_Exit);
  itk::OutputWindow::SetInstance(m_Window);
  if (!m_Captured)
  {
    dup2(m_Output, STDOUT_FILENO);
    dup2(m_Error, STDERR_FILENO);
    close(m_Output);
    close(m_Error);
  }
}

void
Session::Print(const std::string & text)
{
  if (!quiet)
  {
    this->PrintAlways(text);
  }
}

void
Session::PrintAlways(const std::string & text)
{
  if (m_PrintError == 0)
  {
    const std::lock_guard<std::mutex> lock(m_ErrorMutex);
    this->ClearProgress();
    this->WriteOutput(text);
  }
}

void
Session::WriteOutput(const std::string & text)
{
  if (m_Captured)
  {
    m_Printed += text;
  }
  else
  {
    m_PrintError = WriteAll(m_Output, text);
  }
}

void
Session::WriteError(const std::string & text)
{
  if (m_Captured)
  {
    m_Messages += text;
  }
  else
  {
    WriteAll(m_Error, text); // there is nobody to tell that it fails
  }
}

void
Session::WriteLine(const std::string & line)
{
  const std::lock_guard<std::mutex> lock(m_ErrorMutex);
  this->ClearProgress();
  this->WriteError(line + '\n');
}

void
Session::Finish() const
{
  if (m_PrintError != 0 && m_PrintError != EPIPE)
  {
    RefuseToWrite("standard output", "cannot write", m_PrintError);
  }
  if (m_StatusFile && m_StatusFile->GetError() != 0)
  {
    RefuseToWrite(status, "cannot write", m_StatusFile->GetError());
  }
}

std::string
Session::Heading() const
{
  return "bonetk" + (command.empty() ? "" : " " + command) + ": " + (subject.empty() ? "" : subject + ": ");
}

void
Session::ForgetWarnings(std::size_t count)
{
  const std::lock_guard<std::timed_mutex> lock(m_Mutex);
  m_Warnings.resize(std::min(count, m_Warnings.size()));
}

void
Session::Warn(const std::string & message)
{
  this->Warn(message, !quiet);
}

void
Session::WarnAlways(const std::string & message)
{
  this->Warn(message, true);
}

void
Session::Warn(const std::string & message, bool shown)
{
  {
    const std::lock_guard<std::timed_mutex> lock(m_Mutex);
    if (std::find(m_Warnings.begin(), m_Warnings.end(), message) != m_Warnings.end())
    {
      return;
    }
    m_Warnings.push_back(message);
    m_AllWarnings.push_back(OneLine((subject.empty() ? "" : subject + ": ") + message));
  }
  if (shown)
  {
    this->WriteLine(OneLine(this->Heading() + "warning: " + message));
  }
}

void
Session::Fail(const std::string & message)
{
  {
    const std::lock_guard<std::timed_mutex> lock(m_Mutex);
    m_Failure = OneLine((subject.empty() ? "" : subject + ": ") + message);
    if (!subject.empty())
    {
      m_AllWarnings.push_back(m_Failure); // others follow
    }
  }
  this->WriteLine(OneLine(this->Heading() + message));
}

void
Session::Fail(const std::exception & error)
{
  const auto * ofItk = dynamic_cast<const itk::ExceptionObject *>(&error);
  std::string  message = ofItk == nullptr ? error.what() : ErrorLine(*ofItk);
  if (IsOfMemory(error))
  {
    message = "not enough memory for this input";
  }
  const auto named = [&message](const std::string & input) { return message.find(input) != std::string::npos; };
  if (dynamic_cast<const IOError *>(&error) == nullptr && std::none_of(inputs.begin(), inputs.end(), named))
  {
    std::string names;
    for (auto input = inputs.begin(); input != inputs.end(); ++input)
    {
      const bool again = std::find(inputs.begin(), input, *input) != input; // as a CT may be its own label map
      names += again ? "" : (names.empty() ? "" : ", ") + *input;
    }
    message = names + (names.empty() ? "" : ": ") + message;
  }
  this->Fail(message);
}

void
Session::Start()
{
  if (!status.empty())
  {
    try
    {
      auto                                    file = std::make_unique<StatusFile>(status, m_Output, m_Error);
      const std::lock_guard<std::timed_mutex> lock(m_Mutex);
      m_StatusFile = std::move(file);
    }
    catch (const MachineError &)
    {
      throw;
    }
    catch (const IOError & error)
    {
      throw UsageError(ErrorLine(error));
    }
    const nlohmann::ordered_json more{ { "command", command }, { "version", version }, { "inputs", inputs } };
    m_StatusFile->Write(this->StatusLine("start", 0, more));
    if (m_StatusFile->GetError() != 0)
    {
      RefuseToWrite(status, "cannot write", m_StatusFile->GetError());
    }
  }
  if (m_StatusFile || this->ShowsProgress())
  {
    m_Ticker = std::thread([this] {
      std::unique_lock<std::mutex> lock(m_TickerMutex);
      while (!m_TickerStop.wait_for(lock, std::chrono::milliseconds(200), [this] { return m_Stopping; }))
      {
        this->Tick();
      }
    });
  }
}

int
Session::End(int exitCode)
{
  int        none = -1;
  const bool first = m_Exit.compare_exchange_strong(none, exitCode);
  if (m_Ticker.joinable())
  {
    {
      const std::lock_guard<std::mutex> lock(m_TickerMutex);
      m_Stopping = true;
    }
    m_TickerStop.notify_all();
    m_Ticker.join();
  }
  {
    const std::lock_guard<std::mutex> lock(m_ErrorMutex);
    this->ClearProgress();
  }
  if (first && exitCode >= 0 && m_StatusFile)
  {
    m_StatusFile->Write(this->EndLine(exitCode), true);
  }
  return first ? exitCode : none;
}

int
Session::Interrupt(int exitCode, const std::string & reason)
{
  int none = -1;
  if (!m_Exit.compare_exchange_strong(none, exitCode))
  {
    return none;
  }
  const std::unique_lock<std::timed_mutex> lock(m_Mutex, std::chrono::milliseconds(500));
  if (lock.owns_lock() && m_StatusFile)
  {
    m_Failure = reason;
    m_StatusFile->WriteLastNow(this->EndLine(exitCode));
  }
  return exitCode;
}

void
Session::Expect(const std::vector<ExpectedStage> & stages, double from, double to)
{
  const std::lock_guard<std::timed_mutex> lock(m_Mutex);
  m_Progress.Expect(stages, from, to);
}

void
Session::Watch(itk::ProcessObject * filter, const std::string & name)
{
  if (!verbose && !m_Captured && !m_Ticker.joinable())
  {
    return;
  }
  const auto run = std::make_shared<int>(-1);
  filter->AddObserver(itk::StartEvent(), [this, run, filter, name](const itk::EventObject &) {
    {
      const std::lock_guard<std::timed_mutex> lock(m_Mutex);
      m_Progress.GiveUp(*run); // where the last run failed
      m_Running.erase(*run);
    }
    *run = this->BeginRun(name);
    const std::lock_guard<std::timed_mutex> lock(m_Mutex);
    m_Running[*run] = filter;
  });
  filter->AddObserver(itk::ProgressEvent(), [this, run, filter](const itk::EventObject &) {
    this->ThrowIfStopped();
    const std::lock_guard<std::timed_mutex> lock(m_Mutex);
    m_Progress.Report(*run, filter->GetProgress());
  });
  filter->AddObserver(itk::EndEvent(), [this, run](const itk::EventObject &) {
    {
      const std::lock_guard<std::timed_mutex> lock(m_Mutex);
      m_Running.erase(*run);
    }
    this->EndRun(*run);
  });
}

Session::Stage::Stage(Session & session, const std::string & name)
  : m_Session(session)
  , m_Run(session.BeginRun(name))
  , m_Exceptions(std::uncaught_exceptions())
{}

Session::Stage::~Stage()
{
  if (std::uncaught_exceptions() == m_Exceptions)
  {
    m_Session.EndRun(m_Run);
  }
}

int
Session::BeginRun(const std::string & name)
{
  this->ThrowIfStopped();
  const std::lock_guard<std::timed_mutex> lock(m_Mutex);
  m_Subject = subject;
  return m_Progress.Begin(name);
}

void
Session::EndRun(int run)
{
  std::string name;
  double      seconds = 0.0;
  {
    const std::lock_guard<std::timed_mutex> lock(m_Mutex);
    name = m_Progress.End(run, seconds);
  }
  if (verbose && !name.empty())
  {
    char text[32];
    std::snprintf(text, sizeof text, " %.1f s", seconds);
    this->WriteLine(this->Heading() + name + text);
  }
}

void
Session::Tick()
{
  if (this->ShowsProgress())
  {
    this->ShowProgress();
  }
  std::string line;
  if (m_StatusFile)
  {
    const std::lock_guard<std::timed_mutex> lock(m_Mutex);
    const std::string                       stage = m_Progress.GetStage();
    const Shown now{ stage.empty() ? m_Told.stage : stage, m_Subject, m_Progress.GetShare(), m_AllWarnings.size() };
    constexpr double least = 0.001;
    if (now.stage != m_Told.stage || now.subject != m_Told.subject || now.share >= m_Told.share + least ||
        now.warnings > m_Told.warnings)
    {
      line = this->StatusLine(now.stage, m_Told.warnings, nlohmann::ordered_json::object());
      m_Told = now;
    }
  }
  if (!line.empty())
  {
    m_StatusFile->Write(line);
  }
}

std::string
Session::StatusLine(const std::string & stage, std::size_t first, const nlohmann::ordered_json & more) const
{
  nlohmann::ordered_json line{ { "stage", stage } };
  line["share"] = std::floor(1e3 * m_Progress.GetShare()) / 1e3;
  line["warnings"] =
    std::vector<std::string>(m_AllWarnings.begin() + static_cast<std::ptrdiff_t>(first), m_AllWarnings.end());
  line["seconds"] = std::round(1e2 * this->Seconds()) / 1e2;
  if (!m_Subject.empty() && stage != "end")
  {
    line["subject"] = m_Subject;
  }
  line.update(more);
  return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string
Session::EndLine(int exitCode) const
{
  nlohmann::ordered_json more{ { "exit", exitCode } };
  if (exitCode == 0)
  {
    more["share"] = 1.0;
  }
  else
  {
    more["error"] = m_Failure;
  }
  return this->StatusLine("end", 0, more);
}

double
Session::Seconds() const
{
  return std::chrono::duration<double>(Progress::Clock::now() - m_Start).count();
}

void
Session::ShowProgress()
{
  constexpr double leastSeconds = 1.0, leastShare = 0.02;
  const double     seconds = this->Seconds();
  std::string      stage, line;
  double           share = 0.0;
  {
    const std::lock_guard<std::timed_mutex> lock(m_Mutex);
    stage = (m_Subject.empty() ? "" : m_Subject + ": ") + m_Progress.GetStage();
    share = m_Progress.GetStage().empty() ? -1.0 : m_Progress.GetShare();
  }
  if (share >= 0.0 && seconds >= leastSeconds)
  {
    char number[16];
    std::snprintf(number, sizeof number, " %3d %%", static_cast<int>(100.0 * share));
    line = "bonetk " + command + ": " + stage + number +
           (share >= leastShare ? ", " + TimeLeft(seconds * (1.0 - share) / share) : "");
    line.resize(std::min(line.size(), WidthOf(m_Error) - 1));
  }
  const std::lock_guard<std::mutex> lock(m_ErrorMutex);
  if (line != m_ProgressLine)
  {
    const std::size_t shorter = m_ProgressLine.size() - std::min(m_ProgressLine.size(), line.size());
    this->WriteError('\r' + line + std::string(shorter, ' ') + (line.empty() ? "\r" : ""));
    m_ProgressLine = line;
  }
}

void
Session::ClearProgress()
{
  if (!m_ProgressLine.empty())
  {
    this->WriteError('\r' + std::string(m_ProgressLine.size(), ' ') + '\r');
    m_ProgressLine.clear();
  }
}
} // namespace bone
