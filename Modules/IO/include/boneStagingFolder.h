/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStagingFolder_h
#define boneStagingFolder_h

#include <functional>
#include <memory>
#include <string>

namespace bone
{
/** \class StagingFolder
 * \brief Lets the files of an output folder appear under their names only when all are written.
 *
 * Files are written to GetPath(), a new hidden folder beside the output folder. Commit() renames it to the output
 * folder, or, where that exists already, moves the files into it, each replacing one of its name, and removes from it
 * the files that are out of date: all or none, with those of an \ref OutputTransaction where there is one. Without
 * Commit() the destructor removes what was written. Throws IOError where the parent folder is missing or cannot be
 * written to, or the output's name is that of a file. */
class StagingFolder
{
public:
  explicit StagingFolder(const std::string & folder);
  StagingFolder(const StagingFolder &) = delete;
  StagingFolder &
  operator=(const StagingFolder &) = delete;
  ~StagingFolder() = default;

  const std::string &
  GetPath() const
  {
    return m_Path;
  }

  /** `isOutOfDate` is asked of the names of files that the output folder held before and that are not written anew. */
  void
  Commit(const std::function<bool(const std::string &)> & isOutOfDate = nullptr);

private:
  std::shared_ptr<void> m_Owner; ///< removes the hidden folder
  std::string           m_Folder;
  std::string           m_Path;
};

/** Whether the path lies in the hidden folder of a StagingFolder. */
bool
IsStaged(const std::string & path);

/** Removes the hidden folders of all StagingFolder objects. */
void
RemoveStagingFolders();
} // namespace bone

#endif
