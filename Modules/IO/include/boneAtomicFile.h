/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneAtomicFile_h
#define boneAtomicFile_h

#include <memory>
#include <string>
#include <vector>

namespace bone
{
/** \class AtomicFile
 * \brief Lets a file appear under its name only when it is whole.
 *
 * The content is written to GetTemporaryPath(), which has the final file's name and lies in a new hidden folder
 * `.bonetk-tmp-XXXXXX` beside it, so that writers that choose the format by the extension, or that put a second file
 * beside the first (`.mhd` and `.raw`), work as ever. Commit() flushes to the disk and renames; companion files are
 * renamed before the named one. Without Commit() everything is removed at the end. A symbolic link is followed and
 * stays. Not thread-safe per object; different objects may be used at the same time.
 *
 * Throws IOError where the folder does not exist or cannot be written to, or the path names anything but a regular
 * file (a folder, a device). */
class AtomicFile
{
public:
  explicit AtomicFile(const std::string & path);
  AtomicFile(const AtomicFile &) = delete;
  AtomicFile &
  operator=(const AtomicFile &) = delete;
  ~AtomicFile() = default;

  /** The final name, as given. */
  const std::string &
  GetPath() const
  {
    return m_Path;
  }

  /** Where to write to. */
  const std::string &
  GetTemporaryPath() const
  {
    return m_TemporaryPath;
  }

  /** Writes the whole content to the temporary path. Throws IOError where the disk is full. */
  void
  Write(const std::string & content);

  /** Puts the written file in its place, with the mode of the file that it replaces; where an \ref OutputTransaction
   * lives, when that is committed. Throws IOError, and leaves the former file as it was, where nothing or an empty file
   * was written or the disk is full. */
  void
  Commit();

private:
  struct Pending;
  struct Temporary;

  std::string                m_Path;   // as given, for messages
  std::string                m_Target; // absolute, links resolved
  std::string                m_TemporaryPath;
  std::shared_ptr<Temporary> m_Temporary; // until Commit()

  friend void
  RemovePendingTemporaries() noexcept;
};

/** Writes `content` to `path` as a whole or not at all. Throws IOError. */
void
WriteFileAtomically(const std::string & path, const std::string & content);

/** Removes the temporaries of all living AtomicFile objects. For a handler of SIGINT or SIGTERM just before it ends the
 * process: it only unlinks files by names made beforehand, which is async-signal-safe. Objects whose temporaries were
 * removed throw from Commit(). */
void
RemovePendingTemporaries() noexcept;
} // namespace bone

#endif
