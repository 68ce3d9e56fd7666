/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtomicFile.h"

#include "boneIOError.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
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

std::string
ErrorText(int code)
{
  return std::strerror(code);
}

void
Flush(const std::string & path, const std::string & file)
{
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
  {
    throw IOError(path, "cannot write: " + ErrorText(errno));
  }
  const int status = ::fsync(descriptor);
  const int code = errno;
  ::close(descriptor);
  // File systems without fsync say EINVAL; there is nothing to wait for.
  if (status != 0 && code != EINVAL)
  {
    throw IOError(path, "cannot write: " + ErrorText(code));
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
    throw IOError(path, "cannot write: " + ErrorText(errno));
  }
}
} // namespace

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
  std::string name = (folder / ".bonetk-tmp-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
  {
    throw IOError(path, "cannot write into the folder '" + folder.string() + "': " + ErrorText(errno));
  }
  m_Target = target.string();
  m_Folder = name;
  m_TemporaryPath = (fs::path(name) / target.filename()).string();

  m_Pending = std::make_unique<Pending>();
  m_Pending->folder = m_Folder;
  m_Pending->files.push_back(m_TemporaryPath);
  for (const char * extension : CompanionExtensions)
  {
    m_Pending->files.push_back(fs::path(m_TemporaryPath).replace_extension(extension).string());
  }
  for (int slot = 0; slot < NumberOfSlots && m_Slot < 0; ++slot)
  {
    const void * expected = nullptr;
    if (Slots[slot].compare_exchange_strong(expected, m_Pending.get()))
    {
      m_Slot = slot;
    }
  }
}

AtomicFile::~AtomicFile()
{
  this->Discard();
}

void
AtomicFile::Discard() noexcept
{
  if (m_Slot >= 0 && Slots[m_Slot].exchange(nullptr) == nullptr)
  {
    // The handler has the names and may be reading them still: they stay to the end of the process.
    static std::mutex                            mutex;
    static std::vector<std::unique_ptr<Pending>> kept;
    const std::lock_guard<std::mutex>            lock(mutex);
    kept.push_back(std::move(m_Pending));
  }
  m_Slot = -1;
  if (!m_Folder.empty())
  {
    std::error_code error;
    fs::remove_all(m_Folder, error);
    m_Folder.clear();
  }
}

std::vector<std::string>
AtomicFile::WrittenFiles() const
{
  std::vector<std::string> files;
  std::error_code          error;
  for (const auto & entry : fs::directory_iterator(m_Folder, error))
  {
    files.push_back(entry.path().string());
  }
  // The named file last: a reader that finds it finds its companions.
  std::sort(files.begin(), files.end(), [this](const std::string & a, const std::string & b) {
    return (a == m_TemporaryPath) != (b == m_TemporaryPath) ? b == m_TemporaryPath : a < b;
  });
  return files;
}

void
AtomicFile::Commit()
{
  const auto      files = this->WrittenFiles();
  std::error_code error;
  const auto      size = fs::file_size(m_TemporaryPath, error);
  if (error || size == 0)
  {
    throw IOError(m_Path, "cannot write: nothing reached the disk (is it full?)");
  }
  for (const auto & file : files)
  {
    Flush(m_Path, file);
  }
  const fs::path folder = fs::path(m_Target).parent_path();
  for (const auto & file : files)
  {
    const fs::path to = file == m_TemporaryPath ? fs::path(m_Target) : folder / fs::path(file).filename();
    if (::rename(file.c_str(), to.c_str()) != 0)
    {
      throw IOError(m_Path, "cannot write: " + ErrorText(errno));
    }
  }
  this->Discard();
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
    throw IOError(m_Path, "cannot write: " + ErrorText(errno));
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
