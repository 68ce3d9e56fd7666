/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStatusFile_h
#define boneStatusFile_h

#include <atomic>
#include <mutex>
#include <string>

namespace bone
{
/** \class StatusFile
 * \brief Lines that a program reads while a command works: a file, a pipe, or a descriptor such as /dev/fd/3.
 *
 * Every line is one write, seen at once; it lives while the work goes, and is no output of an \ref OutputTransaction. A
 * file that is there is replaced only if it is empty or a status file of an earlier run. A reader that is gone is no
 * error. Any thread may write. */
class StatusFile
{
public:
  /** `output` and `error` are where the process's standard streams go. Opening a named pipe waits for its reader.
   * Throws IOError where it cannot be written to. */
  StatusFile(const std::string & path, int output, int error);
  ~StatusFile();
  StatusFile(const StatusFile &) = delete;
  StatusFile &
  operator=(const StatusFile &) = delete;

  /** Writes a line, waiting for a slow reader. After the last one nothing is written. */
  void
  Write(const std::string & line, bool last = false);

  /** The last line of a process that is about to end, which waits for nobody: a line that the reader does not take in
   * half a second is lost. */
  void
  WriteLastNow(const std::string & line);

  /** errno of the first line that could not be written; 0 where none was lost, or the reader is gone. */
  int
  GetError() const
  {
    return m_Error;
  }

private:
  int              m_File{ -1 };
  std::atomic<int> m_Error{ 0 };
  bool             m_Ended{ false };
  std::timed_mutex m_Mutex;
};

/** Writes all of the text. Returns 0, or errno where it cannot be written. Where `patience` is not negative, a reader
 * that takes nothing for so many ms is an error. */
int
WriteAll(int file, const std::string & text, int patience = -1);
} // namespace bone

#endif
