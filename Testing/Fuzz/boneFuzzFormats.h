/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFuzzFormats_h
#define boneFuzzFormats_h

#include "boneMutator.h"

#include <functional>
#include <string>
#include <vector>

namespace bone
{
/** A format: the file that is damaged, and who reads it. */
struct FuzzFormat
{
  std::string file; ///< in the folder of \ref WriteFuzzSeeds

  /** Reads the file of this path and works with what is read, as commands do. Null: only a command reads it. */
  std::function<void(const std::string &)> use;

  /** Command lines of bonetk that read it, run in its folder; they write into out/. */
  std::vector<std::string> commands;

  bool gzip{ false }; ///< damaged within, too

  Payload payload{ Payload::Unchecked };

  /** Whether two files hold the same, where there is a checked payload. */
  std::function<bool(const std::string &, const std::string &)> same{};

  std::vector<std::string> names{}; ///< of which errors have to hold one, where it is not the file's
};

std::vector<FuzzFormat>
FuzzFormats();
} // namespace bone

#endif
