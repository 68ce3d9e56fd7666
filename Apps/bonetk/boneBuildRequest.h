/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildRequest_h
#define boneBuildRequest_h

#include "boneSession.h"

#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

namespace bone
{
/** What a command is asked for, by which a repetition is known: the program (version and commit), its inputs by their
 * checksums, and its options. inputs: role and path; those without a path are left out. Null where it cannot be known:
 * of a program from sources that differ from their commit, and where an input cannot be read, or its voxels lie in a
 * file beside it. */
nlohmann::json
DescribeRequest(const std::vector<std::pair<std::string, std::string>> & inputs, nlohmann::json options);

/** Whether the folder holds all outputs of a build of this request: as many and as large as its report.json says.
 * Then the session gets its warnings anew, and the outputs' names. Of several bones, `folder` is that of one of them.
 */
bool
IsBuilt(const std::string & folder, const nlohmann::json & request, Session & session);

/** The same for all bones of a build of several, each in a folder in this one. */
bool
AreBuilt(const std::string & folder, const nlohmann::json & request, Session & session);
} // namespace bone

#endif
