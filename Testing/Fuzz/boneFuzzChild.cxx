/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneFuzzChild.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace
{
namespace fs = std::filesystem;

// 99 is SanitizerExitCode: with the sanitizers' own 1 a report would pass for a refusal.
constexpr const char * SanitizerOptions =
  "exitcode=99:hard_rss_limit_mb=4096:max_allocation_size_mb=4096:allocator_may_return_null=1:detect_leaks=0:"
  "print_stacktrace=1";
} // namespace

#if defined(__SANITIZE_ADDRESS__)
extern "C" const char *
__asan_default_options()
{
  return SanitizerOptions;
}
extern "C" const char *
__ubsan_default_options()
{
  return SanitizerOptions;
}
#endif

namespace bone
{
namespace
{
void
SetLimits()
{
  // Of the processor's time, as a machine may have other work; what waits without working is found by the alarm.
  const rlimit seconds{ LongestFuzzSeconds, LongestFuzzSeconds };
  setrlimit(RLIMIT_CPU, &seconds);
  alarm(6 * LongestFuzzSeconds);
#if !defined(__SANITIZE_ADDRESS__)
  // The sanitizers' shadow takes terabytes of addresses, and they limit memory themselves.
  const rlimit limit{ rlim_t{ LargestFuzzGigabytes } << 30, rlim_t{ LargestFuzzGigabytes } << 30 };
  setrlimit(RLIMIT_AS, &limit);
#endif
}

bool
HasReport(const std::string & log)
{
  const std::string text = ReadBytes(log);
  return text.find("ERROR: AddressSanitizer") != std::string::npos || text.find("runtime error:") != std::string::npos;
}
} // namespace

ChildEnd
RunInChild(const std::function<int()> & action, const std::string & log)
{
  const pid_t child = fork();
  if (child == 0)
  {
    const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    SetLimits();
    _exit(action());
  }
  int    status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  ChildEnd end;
  end.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (WIFSIGNALED(status))
  {
    const int  number = WTERMSIG(status);
    const auto seconds = usage.ru_utime.tv_sec + usage.ru_stime.tv_sec;
    const bool late = number == SIGALRM || seconds + 1 >= time_t{ LongestFuzzSeconds };
    end.wrong = late ? "takes too long" : "signal " + std::to_string(number);
  }
  else if (end.code == SanitizerExitCode || HasReport(log))
  {
    end.wrong = "a sanitizer's report";
  }
  else if (usage.ru_maxrss > long{ LargestFuzzGigabytes } << 20)
  {
    end.wrong = "needs " + std::to_string(usage.ru_maxrss >> 20) + " GB";
  }
  return end;
}

ChildEnd
RunProgram(const std::vector<std::string> & command, const std::string & folder, const std::string & log)
{
  // The program may put its standard error elsewhere: the sanitizers' reports go to files, and then into the log.
  const std::string reports = log + ".report";
  const std::string options = SanitizerOptions + std::string(":log_path=") + reports;
  ChildEnd          end = RunInChild(
    [&] {
      setenv("ASAN_OPTIONS", options.c_str(), 1);
      setenv("UBSAN_OPTIONS", options.c_str(), 1);
      std::vector<char *> words;
      for (const std::string & word : command)
      {
        words.push_back(const_cast<char *>(word.c_str()));
      }
      words.push_back(nullptr);
      if (chdir(folder.c_str()) == 0)
      {
        execv(words[0], words.data());
      }
      return 127;
    },
    log);
  for (const auto & entry : fs::directory_iterator(fs::path(log).parent_path()))
  {
    if (entry.path().string().rfind(reports, 0) == 0)
    {
      std::ofstream(log, std::ios::app) << ReadBytes(entry.path().string());
      fs::remove(entry.path());
      end.wrong = end.wrong.empty() && HasReport(log) ? "a sanitizer's report" : end.wrong;
    }
  }
  return end;
}

std::string
FindMessageFault(const std::string & message)
{
  constexpr std::size_t   longest = 1000; // a list of twenty labels
  static const std::regex internals(
    R"((\b0x[0-9a-f]{6}|[a-z]+\.exception|\.(cxx|hxx|cpp|cc|h):|\bitk[A-Z:]|\bvtk[A-Z]|\bgdcm|\bGDCM|\bDCMTK|\bDcm[A-Z])"
    R"(|\bH5[A-Z]|HDF5|MetaIO|MetaImage:|nifti_|\bstd::|bad_alloc|basic_string|vector::|stod|stoi|\b[GS]et[A-Z][a-z]+)"
    R"(|Determinant|Failed to allocate|NULL|ITK ERROR|Exception))");
  if (message.empty())
  {
    return "is empty";
  }
  if (message.size() > longest)
  {
    return "has " + std::to_string(message.size()) + " letters";
  }
  if (std::any_of(message.begin(), message.end(), [](unsigned char c) { return c < ' ' || c == 127; }))
  {
    return "has line breaks, or signs that cannot be printed";
  }
  std::smatch found;
  return std::regex_search(message, found, internals) ? "speaks of '" + found.str() + "'" : "";
}

std::string
ReadBytes(const std::string & path)
{
  std::ifstream stream(path, std::ios::binary);
  return { std::istreambuf_iterator<char>(stream), {} };
}

void
WriteBytes(const std::string & path, const std::string & bytes)
{
  std::ofstream(path, std::ios::binary) << bytes;
}
} // namespace bone
