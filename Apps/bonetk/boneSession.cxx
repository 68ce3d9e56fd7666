/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSession.h"

#include "boneIOError.h"

#include <itkCommand.h>
#include <itkOutputWindow.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <regex>

#include <fcntl.h>
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

/** Writes all of the text. Returns 0, or errno where it cannot be written. */
int
WriteAll(int file, const std::string & text)
{
  for (std::size_t done = 0; done < text.size();)
  {
    const ssize_t count = write(file, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR)
    {
      return errno;
    }
    done += count < 0 ? 0 : static_cast<std::size_t>(count);
  }
  return 0;
}
} // namespace

Session::Session()
  : m_Start(std::chrono::steady_clock::now())
  , m_Output(dup(STDOUT_FILENO))
  , m_Error(dup(STDERR_FILENO))
  , m_Terminal(isatty(STDERR_FILENO) == 1)
{
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  close(nowhere);
  auto window = SessionWindow::New();
  window->SetSession(this);
  itk::OutputWindow::SetInstance(window);
}

Session::~Session()
{
  this->ClearProgress();
  itk::OutputWindow::SetInstance(nullptr);
  dup2(m_Output, STDOUT_FILENO);
  dup2(m_Error, STDERR_FILENO);
  close(m_Output);
  close(m_Error);
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
    this->ClearProgress();
    m_PrintError = WriteAll(m_Output, text);
  }
}

void
Session::WriteError(const std::string & text)
{
  WriteAll(m_Error, text); // there is nobody to tell that it fails
}

void
Session::Finish() const
{
  if (m_PrintError != 0 && m_PrintError != EPIPE)
  {
    throw IOError("standard output", std::string("cannot write: ") + std::strerror(m_PrintError));
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
  const std::lock_guard<std::mutex> lock(m_Mutex);
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
  const std::lock_guard<std::mutex> lock(m_Mutex);
  if (std::find(m_Warnings.begin(), m_Warnings.end(), message) != m_Warnings.end())
  {
    return;
  }
  m_Warnings.push_back(message);
  if (shown)
  {
    this->ClearProgress();
    this->WriteError(OneLine(this->Heading() + "warning: " + message) + '\n');
  }
}

void
Session::Fail(const std::string & message)
{
  this->ClearProgress();
  this->WriteError(OneLine(this->Heading() + message) + '\n');
}

void
Session::Fail(const std::exception & error)
{
  const auto * ofItk = dynamic_cast<const itk::ExceptionObject *>(&error);
  std::string  message = ofItk == nullptr ? error.what() : ErrorLine(*ofItk);
  if (dynamic_cast<const std::bad_alloc *>(&error) != nullptr ||
      dynamic_cast<const itk::MemoryAllocationError *>(&error) != nullptr)
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
Session::Watch(itk::ProcessObject * filter, const std::string & name)
{
  if (quiet || !m_Terminal)
  {
    return;
  }
  filter->AddObserver(itk::ProgressEvent(),
                      [this, filter, name](const itk::EventObject &) { ShowProgress(name, filter->GetProgress()); });
  filter->AddObserver(itk::EndEvent(), [this](const itk::EventObject &) { this->ClearProgress(); });
}

void
Session::ShowProgress(const std::string & name, double share)
{
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - m_Start;
  if (elapsed.count() < 1.0)
  {
    return;
  }
  char line[80];
  std::snprintf(line, sizeof line, "%-24.24s %3d %%", name.c_str(), static_cast<int>(100.0 * share + 0.5));
  if (line != m_Shown)
  {
    m_Shown = line;
    this->WriteError('\r' + m_Shown);
  }
}

void
Session::ClearProgress()
{
  if (!m_Shown.empty())
  {
    this->WriteError('\r' + std::string(m_Shown.size(), ' ') + '\r');
    m_Shown.clear();
  }
}
} // namespace bone
