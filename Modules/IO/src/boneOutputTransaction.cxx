/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneOutputTransaction.h"

#include "boneAtomicFile.h"
#include "boneIOError.h"
#include "boneStagingFolder.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>
#include <stdexcept>

#include <sys/stat.h>
#include <unistd.h>

namespace bone
{
namespace
{
std::atomic<OutputTransaction *> current{ nullptr };

std::mutex &
RenameMutex()
{
  static std::mutex mutex;
  return mutex;
}

/** Puts back the first `count` moves. */
void
Undo(const std::vector<OutputTransaction::Move> & moves, std::size_t count)
{
  while (count-- > 0)
  {
    const OutputTransaction::Move & move = moves[count];
    struct stat                     former
    {
    };
    if (!move.former.empty() && ::lstat(move.former.c_str(), &former) == 0)
    {
      ::rename(move.former.c_str(), move.to.c_str());
    }
    else
    {
      ::rename(move.to.c_str(), move.from.c_str());
    }
  }
}

void
MoveAll(const std::vector<OutputTransaction::Move> & moves, const std::vector<std::string> & outOfDate)
{
  const std::lock_guard<std::mutex> lock(RenameMutex());
  for (std::size_t i = 0; i < moves.size(); ++i)
  {
    const OutputTransaction::Move & move = moves[i];
    struct stat                     there
    {
    };
    if (::lstat(move.to.c_str(), &there) == 0 && !S_ISDIR(there.st_mode))
    {
      if (S_ISREG(there.st_mode))
      {
        // A file keeps its mode: nobody may read what only its owner could.
        ::chmod(move.from.c_str(), there.st_mode & 07777);
      }
      if (::link(move.to.c_str(), move.former.c_str()) != 0)
      {
        ::rename(move.to.c_str(), move.former.c_str()); // a file system without hard links
      }
    }
    if (::rename(move.from.c_str(), move.to.c_str()) != 0)
    {
      const int code = errno;
      ::rename(move.former.c_str(), move.to.c_str());
      Undo(moves, i);
      RefuseToWrite(move.path, "cannot write", code);
    }
  }
  for (const std::string & file : outOfDate)
  {
    ::unlink(file.c_str());
  }
}
} // namespace

OutputTransaction::OutputTransaction()
{
  OutputTransaction * none = nullptr;
  if (!current.compare_exchange_strong(none, this))
  {
    throw std::logic_error("OutputTransaction: another one lives");
  }
}

OutputTransaction::~OutputTransaction()
{
  current = nullptr;
}

void
OutputTransaction::Commit()
{
  // Whether it succeeds or not, the next Commit() is about others.
  const auto moves = std::exchange(m_Moves, {});
  const auto outOfDate = std::exchange(m_OutOfDate, {});
  const auto owners = std::exchange(m_Owners, {});
  MoveAll(moves, outOfDate);
  for (const Move & move : moves)
  {
    m_Committed.push_back(move.path);
  }
}

void
OutputTransaction::CommitTaken()
{
  if (OutputTransaction * all = current)
  {
    all->Commit();
  }
}

void
OutputTransaction::Take(const std::vector<Move> &        moves,
                        const std::vector<std::string> & outOfDate,
                        const std::shared_ptr<void> &    owner)
{
  OutputTransaction * all = current;
  if (all == nullptr || (!moves.empty() && IsStaged(moves.front().to)))
  {
    MoveAll(moves, outOfDate);
    return;
  }
  const std::lock_guard<std::mutex> lock(RenameMutex());
  for (const Move & move : moves)
  {
    const auto same = [&move](const Move & other) { return other.to == move.to; };
    if (std::any_of(all->m_Moves.begin(), all->m_Moves.end(), same))
    {
      throw IOError(move.path, "is the name of two outputs: give each a name of its own");
    }
  }
  all->m_Moves.insert(all->m_Moves.end(), moves.begin(), moves.end());
  all->m_OutOfDate.insert(all->m_OutOfDate.end(), outOfDate.begin(), outOfDate.end());
  all->m_Owners.push_back(owner);
}

std::unique_lock<std::mutex>
OutputTransaction::Hold()
{
  return std::unique_lock<std::mutex>(RenameMutex());
}

void
OutputTransaction::StopAll()
{
  RenameMutex().lock(); // and never given back
  RemovePendingTemporaries();
  RemoveStagingFolders();
}

void
OutputTransaction::FinishAll()
{
  RenameMutex().lock(); // and never given back
}
} // namespace bone
