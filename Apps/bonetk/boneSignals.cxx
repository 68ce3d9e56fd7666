/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSignals.h"

#include "boneOutputTransaction.h"

#include <csignal>
#include <mutex>
#include <thread>

#include <pthread.h>
#include <unistd.h>

namespace bone
{
namespace
{
std::mutex lastMutex;

std::function<int(int, const std::string &)> &
Last()
{
  static std::function<int(int, const std::string &)> last;
  return last;
}

std::string
NameOf(int signal)
{
  return signal == SIGINT ? "SIGINT" : signal == SIGTERM ? "SIGTERM" : signal == SIGHUP ? "SIGHUP" : "SIGQUIT";
}

void
WaitForSignals(sigset_t signals)
{
  int received = 0;
  sigwait(&signals, &received);
  OutputTransaction::StopAll();
  const std::lock_guard<std::mutex> lock(lastMutex); // who lives as long as the last words must not end now
  const int                         code = 128 + received;
  _exit(Last() ? Last()(code, "interrupted by " + NameOf(received)) : code);
}
} // namespace

LastWords::LastWords(const std::function<int(int exitCode, const std::string & reason)> & last)
{
  const std::lock_guard<std::mutex> lock(lastMutex);
  Last() = last;
}

LastWords::~LastWords()
{
  const std::lock_guard<std::mutex> lock(lastMutex);
  Last() = nullptr;
}

void
InstallSignalHandling()
{
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : { SIGINT, SIGTERM, SIGHUP, SIGQUIT })
  {
    sigaddset(&signals, signal);
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread(WaitForSignals, signals).detach();
}
} // namespace bone
