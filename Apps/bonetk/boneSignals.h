/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSignals_h
#define boneSignals_h

#include <functional>
#include <string>

namespace bone
{
/** From here on SIGINT, SIGTERM, SIGHUP and SIGQUIT remove the temporaries of all outputs and end the process, with 128
 * and the signal's number; a file too large for the user's limit, and a pipe that nobody reads any more, are errors of
 * the write and no signals. Call it before the first thread starts. */
void
InstallSignalHandling();

/** As long as it lives, a signal that ends the process first calls `last` with the exit code and what happened, on a
 * thread of its own; the process ends with the code that `last` returns. One at a time. */
class LastWords
{
public:
  explicit LastWords(const std::function<int(int exitCode, const std::string & reason)> & last);
  ~LastWords();
  LastWords(const LastWords &) = delete;
  LastWords &
  operator=(const LastWords &) = delete;
};
} // namespace bone

#endif
