/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStagingFolder_h
#define boneStagingFolder_h

#include <string>

namespace bone
{
/** \class StagingFolder
 * \brief Lets the files of an output folder appear under their names only when all are written.
 *
 * Files are written to GetPath(), a new hidden folder beside the output folder. Commit() renames it to the output
 * folder, or, where that exists already, moves the files into it one by one, each replacing one of its name. Without
 * Commit() the destructor removes what was written. Throws IOError where the parent folder is missing or cannot be
 * written to, or the output's name is that of a file. */
class StagingFolder
{
public:
  explicit StagingFolder(const std::string & folder);
  ~StagingFolder();
  StagingFolder(const StagingFolder &) = delete;
  StagingFolder &
  operator=(const StagingFolder &) = delete;

  const std::string &
  GetPath() const
  {
    return m_Path;
  }
  void
  Commit();

private:
  std::string m_Folder;
  std::string m_Path;
};

/** From here on SIGINT and SIGTERM remove the temporaries of all living StagingFolder and AtomicFile objects and end
 * the process with 130 and 1; a file too large for the user's limit is an error of the write and no signal. Call it
 * before the first thread starts. */
void
InstallSignalHandling();

/** From here on SIGINT and SIGTERM change nothing: the outputs are in place or given up, and the process ends with the
 * exit code that says so. Call it once, when no StagingFolder lives any more and nothing but the end of main() is
 * left. */
void
FinishSignalHandling();
} // namespace bone

#endif
