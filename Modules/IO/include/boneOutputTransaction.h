/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneOutputTransaction_h
#define boneOutputTransaction_h

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace bone
{
/** \class OutputTransaction
 * \brief Several output files appear together or not at all.
 *
 * While one lives, the files and folders that AtomicFile and StagingFolder commit keep their temporary names until its
 * own Commit(), so they cannot be read under their names before. Without Commit() the destructor removes them. Commit()
 * renames them one after another and puts everything back where one fails. One transaction at a time; a second throws
 * std::logic_error. */
class OutputTransaction
{
public:
  /** A file or folder to be renamed. */
  struct Move
  {
    std::string path; ///< as the user gave it, for messages
    std::string from;
    std::string to;
    std::string former; ///< where a file that is replaced is kept until all are renamed; empty: `to` is not there
  };

  OutputTransaction();
  ~OutputTransaction();
  OutputTransaction(const OutputTransaction &) = delete;
  OutputTransaction &
  operator=(const OutputTransaction &) = delete;

  /** Throws IOError where a file cannot be renamed; then all are as they were. What is taken later needs another. */
  void
  Commit();

  /** Files and folders that Commit() gave their names, as the user gave these; those of folders are absolute. */
  const std::vector<std::string> &
  GetCommitted() const
  {
    return m_Committed;
  }

  /** Commits the transaction that lives, where there is one: what follows may fail, and what is done is not lost. */
  static void
  CommitTaken();

  /** Makes the moves and removes the files that they make out of date: in the transaction that lives, or at once.
   * `owner` holds what they need. Throws IOError where a name was taken already by another output. */
  static void
  Take(const std::vector<Move> &        moves,
       const std::vector<std::string> & outOfDate,
       const std::shared_ptr<void> &    owner);

  /** While it is held StopAll() waits: for what is temporary to be made and known, or gone and forgotten. */
  static std::unique_lock<std::mutex>
  Hold();

  /** For a thread that waits for signals, just before it ends the process: removes what is temporary; nothing is
   * renamed from here on. */
  static void
  StopAll();

  /** Nothing is renamed, and StopAll() waits for ever, from here on: the process ends with the exit code that it has.
   */
  static void
  FinishAll();

private:
  std::vector<Move>                  m_Moves;
  std::vector<std::string>           m_OutOfDate;
  std::vector<std::shared_ptr<void>> m_Owners;
  std::vector<std::string>           m_Committed;
};
} // namespace bone

#endif
