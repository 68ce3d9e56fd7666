/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStagingFolder.h"

#include "boneIOError.h"
#include "boneOutputTransaction.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

namespace bone
{
namespace
{
namespace fs = std::filesystem;

std::mutex               stagingMutex;
std::vector<std::string> stagingFolders;

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

struct HiddenFolder
{
  std::string path;

  explicit HiddenFolder(const std::string & name)
    : path(name)
  {
    const std::lock_guard<std::mutex> lock(stagingMutex);
    stagingFolders.push_back(path);
  }
  ~HiddenFolder()
  {
    const auto                        hold = OutputTransaction::Hold();
    const std::lock_guard<std::mutex> lock(stagingMutex);
    stagingFolders.erase(std::remove(stagingFolders.begin(), stagingFolders.end(), path), stagingFolders.end());
    RemoveFolder(path);
  }
  HiddenFolder(const HiddenFolder &) = delete;
  HiddenFolder &
  operator=(const HiddenFolder &) = delete;
};
} // namespace

StagingFolder::StagingFolder(const std::string & folder)
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
  const auto  hold = OutputTransaction::Hold();
  if (mkdtemp(pattern.data()) == nullptr)
  {
    RefuseToWrite(folder, "cannot be made in " + parent.string(), errno);
  }
  m_Path = pattern;
  m_Owner = std::make_shared<HiddenFolder>(m_Path);
  const mode_t mask = umask(0);
  umask(mask);
  chmod(m_Path.c_str(), 0777 & ~mask);
}

void
StagingFolder::Commit(const std::function<bool(const std::string &)> & isOutOfDate)
{
  std::vector<OutputTransaction::Move> moves;
  std::vector<std::string>             outOfDate;
  if (!fs::exists(m_Folder))
  {
    moves.push_back({ m_Folder, m_Path, m_Folder, "" });
  }
  else
  {
    for (const auto & entry : fs::directory_iterator(m_Path))
    {
      const std::string name = entry.path().filename().string();
      const fs::path    target = fs::path(m_Folder) / name;
      if (fs::is_directory(target))
      {
        throw IOError(target.string(), "is a folder where a file is to be written: rename it");
      }
      moves.push_back({ target.string(), entry.path().string(), target.string(), m_Path + "/.former-" + name });
    }
    for (const auto & entry : fs::directory_iterator(m_Folder))
    {
      const std::string name = entry.path().filename().string();
      if (isOutOfDate && entry.is_regular_file() && !fs::exists(fs::path(m_Path) / name) && isOutOfDate(name))
      {
        outOfDate.push_back(entry.path().string());
      }
    }
  }
  OutputTransaction::Take(moves, outOfDate, m_Owner);
  m_Owner.reset();
}

bool
IsStaged(const std::string & path)
{
  const std::string                 folder = fs::absolute(path).lexically_normal().parent_path().string();
  const std::lock_guard<std::mutex> lock(stagingMutex);
  return std::find(stagingFolders.begin(), stagingFolders.end(), folder) != stagingFolders.end();
}

void
RemoveStagingFolders()
{
  const std::lock_guard<std::mutex> lock(stagingMutex);
  for (const std::string & folder : stagingFolders)
  {
    RemoveFolder(folder);
  }
}
} // namespace bone
