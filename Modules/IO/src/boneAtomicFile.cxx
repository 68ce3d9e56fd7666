/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtomicFile.h"

#include "boneIOError.h"
#include "boneOutputTransaction.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <mutex>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace bone
{
namespace fs = std::filesystem;

// Names that a signal handler may read: never changed while they are registered.
struct AtomicFile::Pending
{
  std::vector<std::string> files;
  std::string              folder;
};

namespace
{
// Extensions that ITK's writers of two-file formats give to the second file.
constexpr std::array<const char *, 6> CompanionExtensions = {
  { ".raw", ".zraw", ".raw.gz", ".img", ".img.gz", ".hdr" }
};

constexpr int NumberOfSlots = 256;

// Lock-free, so that a signal handler may look at it at any moment. Who takes a pointer out owns it.
std::atomic<const void *> Slots[NumberOfSlots];

void
Flush(const std::string & path, const std::string & file)
{
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
  {
    RefuseToWrite(path, "cannot write", errno);
  }
  const int status = ::fsync(descriptor);
  const int code = errno;
  ::close(descriptor);
  // File systems without fsync say EINVAL; there is nothing to wait for.
  if (status != 0 && code != EINVAL)
  {
    RefuseToWrite(path, "cannot write", code);
  }
}

void
RequireRegularFile(const std::string & path, const fs::path & target)
{
  std::error_code error;
  const auto      status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
  {
    throw IOError(path, fs::is_directory(status) ? "is a folder: name a file" : "is no regular file: name another");
  }
  if (fs::exists(status) && ::access(target.c_str(), W_OK) != 0)
  {
    RefuseToWrite(path, "cannot write", errno);
  }
}
} // namespace

struct AtomicFile::Temporary
{
  std::string              folder;
  std::string              file; ///< in the folder
  std::unique_ptr<Pending> pending;
  int                      slot{ -1 };

  Temporary(const std::string & path, const fs::path & target);
  ~Temporary();
  Temporary(const Temporary &) = delete;
  Temporary &
  operator=(const Temporary &) = delete;

  /** The files written, the named one last: a reader that finds it finds its companions. */
  std::vector<std::string>
  GetFiles() const;
};

AtomicFile::Temporary::Temporary(const std::string & path, const fs::path & target)
{
  const fs::path parent = target.has_parent_path() ? target.parent_path() : fs::path(".");
  folder = (parent / ".bonetk-tmp-XXXXXX").string();
  const auto hold = OutputTransaction::Hold();
  if (::mkdtemp(folder.data()) == nullptr)
  {
    RefuseToWrite(path, "cannot write into the folder '" + parent.string() + "'", errno);
  }
  file = (fs::path(folder) / target.filename()).string();
  pending = std::make_unique<Pending>();
  pending->folder = folder;
  pending->files.push_back(file);
  for (const char * extension : CompanionExtensions)
  {
    pending->files.push_back(fs::path(file).replace_extension(extension).string());
  }
  for (int i = 0; i < NumberOfSlots && slot < 0; ++i)
  {
    const void * expected = nullptr;
    if (Slots[i].compare_exchange_strong(expected, pending.get()))
    {
      slot = i;
    }
  }
}

AtomicFile::Temporary::~Temporary()
{
  const auto hold = OutputTransaction::Hold();
  if (slot >= 0 && Slots[slot].exchange(nullptr) == nullptr)
  {
    // The handler has the names and may be reading them still: they stay to the end of the process.
    static std::mutex                            mutex;
    static std::vector<std::unique_ptr<Pending>> kept;
    const std::lock_guard<std::mutex>            lock(mutex);
    kept.push_back(std::move(pending));
  }
  std::error_code error;
  fs::remove_all(folder, error);
}

std::vector<std::string>
AtomicFile::Temporary::GetFiles() const
{
  std::vector<std::string> files;
  std::error_code          error;
  for (const auto & entry : fs::directory_iterator(folder, error))
  {
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end(), [this](const std::string & a, const std::string & b) {
    return (a == file) != (b == file) ? b == file : a < b;
  });
  return files;
}

AtomicFile::AtomicFile(const std::string & path)
  : m_Path(path)
{
  std::error_code error;
  fs::path        target = fs::path(path).lexically_normal();
  if (target.filename().empty() || target.filename() == "." || target.filename() == "..")
  {
    throw IOError(path, "names no file");
  }
  for (int links = 0; fs::is_symlink(target, error) && links < 40; ++links)
  {
    target = target.parent_path() / fs::read_symlink(target, error);
  }
  RequireRegularFile(path, target);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error))
  {
    throw IOError(path, "cannot write: there is no folder '" + folder.string() + "'");
  }
  m_Target = fs::absolute(target).lexically_normal().string();
  m_Temporary = std::make_shared<Temporary>(path, target);
  m_TemporaryPath = m_Temporary->file;
}

void
AtomicFile::Commit()
{
  std::error_code error;
  const auto      size = fs::file_size(m_Temporary->file, error);
  if (error || size == 0)
  {
    throw MachineError(m_Path, "cannot write: nothing reached the disk (is it full?)");
  }
  const fs::path                       folder = fs::path(m_Target).parent_path();
  std::vector<OutputTransaction::Move> moves;
  for (const std::string & file : m_Temporary->GetFiles())
  {
    Flush(m_Path, file);
    const std::string name = fs::path(file).filename().string();
    const std::string to = file == m_Temporary->file ? m_Target : (folder / name).string();
    moves.push_back({ m_Path, file, to, (fs::path(m_Temporary->folder) / (".former-" + name)).string() });
  }
  OutputTransaction::Take(moves, {}, m_Temporary);
  m_Temporary.reset();
}

void
AtomicFile::Write(const std::string & content)
{
  errno = 0;
  std::ofstream stream(m_TemporaryPath, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream)
  {
    RefuseToWrite(m_Path, "cannot write", errno);
  }
}

void
WriteFileAtomically(const std::string & path, const std::string & content)
{
  AtomicFile file(path);
  file.Write(content);
  file.Commit();
}

void
RemovePendingTemporaries() noexcept
{
  for (auto & slot : Slots)
  {
    const auto * pending = static_cast<const AtomicFile::Pending *>(slot.exchange(nullptr));
    if (pending != nullptr)
    {
      for (const auto & file : pending->files)
      {
        ::unlink(file.c_str());
      }
      ::rmdir(pending->folder.c_str());
    }
  }
}
} // namespace bone
