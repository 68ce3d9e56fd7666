/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneStatusFile.h"

#include "boneIOError.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <regex>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

namespace bone
{
namespace
{
/** The beginning of every line, so of every status file. */
constexpr char beginning[] = "{\"stage\":";

/** The number of a descriptor that the path names; -1 where it names none. */
int
DescriptorOf(const std::string & path)
{
  static const std::regex descriptor("/dev/std(out|err)|/(?:dev|proc/self)/fd/([0-9]{1,5})");
  std::smatch             found;
  if (!std::regex_match(path, found, descriptor))
  {
    return -1;
  }
  return found[2].matched ? std::stoi(found[2]) : found[1] == "out" ? STDOUT_FILENO : STDERR_FILENO;
}

/** Throws IOError where a file is there that nobody wants to lose. */
void
RequireReplaceable(const std::string & path)
{
  struct stat there
  {
  };
  if (::stat(path.c_str(), &there) != 0)
  {
    return;
  }
  if (S_ISDIR(there.st_mode) || S_ISBLK(there.st_mode))
  {
    throw IOError(path, S_ISDIR(there.st_mode) ? "is a folder: name a file" : "is no regular file: name another");
  }
  if (S_ISREG(there.st_mode) && there.st_size > 0)
  {
    std::ifstream stream(path, std::ios::binary);
    std::string   first(sizeof(beginning) - 1, '\0');
    stream.read(first.data(), static_cast<std::streamsize>(first.size()));
    if (!stream || first != beginning)
    {
      throw IOError(path, "is there and is no status file of an earlier run: name another, or remove it");
    }
  }
}
} // namespace

int
WriteAll(int file, const std::string & text, int patience)
{
  constexpr std::size_t piece = 4096; // which a pipe that poll() calls ready takes without waiting
  for (std::size_t done = 0; done < text.size();)
  {
    pollfd ready{ file, POLLOUT, 0 };
    if (patience >= 0 && ::poll(&ready, 1, patience) == 0)
    {
      return EAGAIN;
    }
    const ssize_t count = write(file, text.data() + done, std::min(piece, text.size() - done));
    if (count < 0 && errno == EAGAIN)
    {
      ::poll(&ready, 1, patience); // a descriptor that does not wait by itself
    }
    else if (count < 0 && errno != EINTR)
    {
      return errno;
    }
    done += count < 0 ? 0 : static_cast<std::size_t>(count);
  }
  return 0;
}

StatusFile::StatusFile(const std::string & path, int output, int error)
{
  const int descriptor = DescriptorOf(path);
  if (descriptor >= 0)
  {
    m_File = ::fcntl(descriptor == STDOUT_FILENO   ? output
                     : descriptor == STDERR_FILENO ? error
                                                   : descriptor,
                     F_DUPFD_CLOEXEC,
                     0);
  }
  else
  {
    RequireReplaceable(path);
    m_File = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
  }
  if (m_File < 0)
  {
    RefuseToWrite(path, "cannot write", errno);
  }
}

StatusFile::~StatusFile()
{
  ::close(m_File);
}

void
StatusFile::Write(const std::string & line, bool last)
{
  const std::lock_guard<std::timed_mutex> lock(m_Mutex);
  if (!m_Ended && m_Error == 0)
  {
    const int error = WriteAll(m_File, line + '\n');
    m_Ended = last || error == EPIPE;
    m_Error = error == EPIPE ? 0 : error;
  }
}

void
StatusFile::WriteLastNow(const std::string & line)
{
  constexpr int                            patience = 500; // ms
  const std::unique_lock<std::timed_mutex> lock(m_Mutex, std::chrono::milliseconds(patience));
  if (lock.owns_lock() && !m_Ended && m_Error == 0)
  {
    m_Ended = true;
    WriteAll(m_File, line + '\n', patience);
  }
}
} // namespace bone
