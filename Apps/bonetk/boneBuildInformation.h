/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildInformation_h
#define boneBuildInformation_h

#include <string>

namespace bone
{
/** What this program was built from, and how. The values are in a source that CMake writes
 * (BoneTKBuildInformation.cmake). */
struct BuildInformation
{
  std::string version;       ///< "0.1.0"
  std::string commit;        ///< of git; empty where the sources came without it
  std::string date;          ///< of the commit, "2026-03-01"; empty without one
  bool        changed{};     ///< whether the sources differ from the commit
  std::string compiler;      ///< "GNU 12.2.0"
  std::string configuration; ///< "Release"
};

const BuildInformation &
GetBuildInformation();

/** "0.1.0, commit 0123456789ab", in one line; without a commit the version alone. */
std::string
DescribeVersion();

/** Version, commit, compiler, and the libraries that are in use, in lines. */
std::string
DescribeBuild();
} // namespace bone

#endif
