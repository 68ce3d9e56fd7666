/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneSignals.h"

#include "boneOutputTransaction.h"

#include <csignal>
#include <thread>

#include <pthread.h>
#include <unistd.h>

namespace bone
{
namespace
{
void
WaitForSignals(sigset_t signals)
{
  int received = 0;
  sigwait(&signals, &received);
  OutputTransaction::StopAll();
  _exit(received == SIGINT ? 130 : 1);
}
} // namespace

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
