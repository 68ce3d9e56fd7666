/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommandLine.h"
#include "boneOutputTransaction.h"
#include "boneSignals.h"

int
main(int argc, char ** argv)
{
  bone::InstallSignalHandling();
  bone::Session         session;
  const bone::LastWords last(
    [&session](int exitCode, const std::string & reason) { return session.Interrupt(exitCode, reason); });
  const int exitCode = bone::RunCommandLine({ argv + 1, argv + argc }, session);
  bone::OutputTransaction::FinishAll();
  return exitCode;
}
