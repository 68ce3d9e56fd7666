/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "bindings.h"

#include "boneCommandLine.h"

#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace py = pybind11;

namespace
{
using ProgressFunction = std::optional<py::function>;
constexpr std::chrono::milliseconds tick(20);

/** The one command that runs in this process: they share the outputs' transaction and ITK's number of threads. */
std::timed_mutex             running;
std::atomic<std::thread::id> runningFor{};

/** Whether it is this thread's turn; signals are handled while it waits. */
std::unique_lock<std::timed_mutex>
WaitForTurn()
{
  if (runningFor.load() == std::this_thread::get_id())
  {
    throw std::runtime_error("a command cannot be called while another one calls its progress function");
  }
  std::unique_lock<std::timed_mutex> turn(running, std::defer_lock);
  while (true)
  {
    {
      const py::gil_scoped_release release;
      if (turn.try_lock_for(tick))
      {
        break;
      }
    }
    if (PyErr_CheckSignals() != 0)
    {
      throw py::error_already_set();
    }
  }
  runningFor = std::this_thread::get_id();
  return turn;
}

/** A command on a thread of its own, so that the caller's can handle signals and call Python. */
class Work
{
public:
  Work(const std::vector<std::string> & words, bone::Session & session)
    : m_Session(session)
    , m_Thread([this, words] {
      const int exitCode = bone::RunCommandLine(words, m_Session);
      {
        const std::lock_guard<std::mutex> lock(m_Mutex);
        m_ExitCode = exitCode;
      }
      m_Ended.notify_all();
    })
  {}
  /** The Python lock is held, or is not. */
  ~Work()
  {
    const bool                            held = PyGILState_Check() != 0;
    std::optional<py::gil_scoped_release> release;
    if (held)
    {
      release.emplace();
    }
    while (!this->WaitForTick())
    {
      m_Session.RequestStop();
    }
    m_Thread.join();
  }
  Work(const Work &) = delete;
  Work &
  operator=(const Work &) = delete;

  /** Whether it has ended. */
  bool
  WaitForTick()
  {
    std::unique_lock<std::mutex> lock(m_Mutex);
    return m_Ended.wait_for(lock, tick, [this] { return m_ExitCode >= 0; });
  }

  int
  GetExitCode() const
  {
    return m_ExitCode;
  }

private:
  bone::Session &         m_Session;
  std::mutex              m_Mutex;
  std::condition_variable m_Ended;
  int                     m_ExitCode{ -1 };
  std::thread             m_Thread;
};

/** Names of files need not be UTF-8. */
py::object
Text(const std::string & text)
{
  return py::reinterpret_steal<py::object>(
    PyUnicode_DecodeFSDefaultAndSize(text.data(), static_cast<py::ssize_t>(text.size())));
}

py::tuple
Texts(const std::vector<std::string> & texts)
{
  py::tuple result(texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i)
  {
    result[i] = Text(texts[i]);
  }
  return result;
}

/** Calls the function where there is news. */
class Progress
{
public:
  explicit Progress(const ProgressFunction & function)
    : m_Function(function)
  {
    this->Tell("start", 0.0);
  }
  void
  Tell(const std::string & stage, double share)
  {
    constexpr double least = 0.001;
    if (m_Function && !stage.empty() && (stage != m_Stage || share >= m_Share + least))
    {
      m_Stage = stage;
      m_Share = share;
      (*m_Function)(Text(stage), share);
    }
  }

private:
  const ProgressFunction & m_Function;
  std::string              m_Stage;
  double                   m_Share{ 0.0 };
};

/** Exit code, and what Python makes its result or error of. An exception of the progress function, or of a signal's
 * handler, stops the work. */
py::dict
RunCommand(const std::vector<std::string> & words, const ProgressFunction & function)
{
  const auto turn = WaitForTurn();
  struct Leave
  {
    ~Leave() { runningFor = std::thread::id(); }
  } const leave;
  Progress      progress(function);
  bone::Session session(bone::SessionStreams::Captured);
  int           exitCode = 0;
  {
    Work work(words, session);
    for (bool ended = false; !ended;)
    {
      {
        const py::gil_scoped_release release;
        ended = work.WaitForTick();
      }
      if (PyErr_CheckSignals() != 0)
      {
        throw py::error_already_set();
      }
      const auto position = session.GetPosition();
      progress.Tell(position.stage, position.share);
    }
    exitCode = work.GetExitCode();
  }
  if (exitCode == 0)
  {
    progress.Tell("end", 1.0);
  }
  py::dict result;
  result["exit"] = exitCode;
  result["command"] = Text(session.commandLine);
  result["text"] = Text(session.GetPrinted());
  result["messages"] = Text(session.GetMessages());
  result["warnings"] = Texts(session.GetAllWarnings());
  result["outputs"] = Texts(session.outputs);
  result["error"] = Text(session.GetFailure());
  return result;
}

py::list
Describe()
{
  py::list commands;
  for (const bone::CommandDescription & command : bone::DescribeCommands())
  {
    py::list options;
    for (const bone::OptionDescription & option : command.options)
    {
      py::dict entry;
      entry["name"] = option.name;
      entry["positional"] = option.positional;
      entry["required"] = option.required;
      entry["flag"] = option.flag;
      entry["negative"] = option.negative;
      entry["type"] = option.type;
      entry["least"] = option.least;
      entry["most"] = option.most;
      entry["each"] = option.each;
      entry["output"] = option.output;
      entry["help"] = option.help;
      options.append(entry);
    }
    py::dict entry;
    entry["name"] = command.name;
    entry["help"] = command.help;
    entry["options"] = options;
    commands.append(entry);
  }
  return commands;
}
} // namespace

void
BindCommands(py::module_ & m)
{
  m.def("run_command", &RunCommand, py::arg("words"), py::arg("progress") = py::none());
  m.def("describe_commands", &Describe, "Every command of the program with its options, as lists of dicts.");
}
