/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStagingFolder.h"

#include "boneAtomicFile.h"
#include "boneIOError.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

namespace bone
{
namespace
{
namespace fs = std::filesystem;

std::mutex &
RegistryMutex()
{
  static std::mutex mutex;
  return mutex;
}

/** Staging folders in use. */
std::vector<std::string> &
Registry()
{
  static std::vector<std::string> folders;
  return folders;
}

void
RemoveFolder(const std::string & path)
{
  // Another thread may be writing into it: try again until it is gone.
  std::error_code error;
  for (int attempt = 0; attempt < 20 && fs::exists(path, error); ++attempt)
  {
    fs::remove_all(path, error);
  }
}

void
WaitForSignals(sigset_t signals)
{
  int received = 0;
  sigwait(&signals, &received);
  // The lock is never given back: nothing may be renamed to its place from here on.
  RegistryMutex().lock();
  RemovePendingTemporaries();
  for (const std::string & folder : Registry())
  {
    RemoveFolder(folder);
  }
  _exit(received == SIGINT ? 130 : 1);
}
} // namespace

StagingFolder::StagingFolder(const std::string & folder)
  : m_Folder(folder)
{
  const fs::path target = fs::absolute(folder).lexically_normal();
  const fs::path named = target.has_filename() ? target : target.parent_path();
  m_Folder = named.string();
  if (fs::exists(named) && !fs::is_directory(named))
  {
    throw IOError(folder, "is a file; give the name of a folder for the output");
  }
  const fs::path parent = named.parent_path();
  if (!fs::is_directory(parent))
  {
    throw IOError(folder, "cannot be made, there is no folder " + parent.string());
  }
  std::string pattern = (parent / ("." + named.filename().string() + "-XXXXXX")).string();

  const std::lock_guard<std::mutex> lock(RegistryMutex());
  if (mkdtemp(pattern.data()) == nullptr)
  {
    throw IOError(folder, "cannot be made in " + parent.string() + ": " + std::strerror(errno));
  }
  m_Path = pattern;
  Registry().push_back(m_Path);
  const mode_t mask = umask(0);
  umask(mask);
  chmod(m_Path.c_str(), 0777 & ~mask);
}

StagingFolder::~StagingFolder()
{
  const std::lock_guard<std::mutex> lock(RegistryMutex());
  Registry().erase(std::remove(Registry().begin(), Registry().end(), m_Path), Registry().end());
  RemoveFolder(m_Path);
}

void
StagingFolder::Commit()
{
  const std::lock_guard<std::mutex> lock(RegistryMutex());
  std::error_code                   error;
  if (!fs::exists(m_Folder))
  {
    fs::rename(m_Path, m_Folder, error);
  }
  else
  {
    for (const auto & entry : fs::directory_iterator(m_Path))
    {
      fs::rename(entry.path(), fs::path(m_Folder) / entry.path().filename(), error);
      if (error)
      {
        break;
      }
    }
  }
  if (error)
  {
    throw IOError(m_Folder, "cannot be written: " + error.message());
  }
}

void
InstallSignalHandling()
{
  std::signal(SIGXFSZ, SIG_IGN);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread(WaitForSignals, signals).detach();
}

void
FinishSignalHandling()
{
  // Never given back: who waits for it in WaitForSignals() stays there until the process has ended.
  RegistryMutex().lock();
}
} // namespace bone
