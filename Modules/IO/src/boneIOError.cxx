/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneIOError.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace bone
{
std::string
OneLine(std::string text)
{
  std::replace_if(
    text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
  const auto end = text.find_last_not_of(' ');
  text.erase(end == std::string::npos ? 0 : end + 1);
  return text;
}

IOError::IOError(const std::string & path, const std::string & message)
  : itk::ExceptionObject(__FILE__, __LINE__)
{
  this->SetDescription(OneLine(path + ": " + message));
}

void
RefuseToWrite(const std::string & path, const std::string & problem, int code)
{
  static constexpr std::array<int, 10> lasting{ ENOENT, ENOTDIR, EISDIR,       EACCES, EPERM,
                                                EROFS,  ELOOP,   ENAMETOOLONG, EBADF,  EINVAL };
  const std::string                    message = problem + ": " + std::strerror(code);
  if (std::find(lasting.begin(), lasting.end(), code) != lasting.end())
  {
    throw IOError(path, message);
  }
  throw MachineError(path, message);
}

std::string
ErrorLine(const itk::ExceptionObject & error)
{
  std::string text = OneLine(error.GetDescription());
  for (const char * prefix : { "ITK ERROR: ", "itk::ERROR: " })
  {
    if (text.rfind(prefix, 0) == 0)
    {
      text.erase(0, std::string(prefix).size());
    }
  }
  const auto address = text.find("(0x");
  const auto colon = text.find("): ");
  if (address != std::string::npos && colon != std::string::npos && address < colon && address < text.find(' '))
  {
    text.erase(0, colon + 3);
  }
  return text;
}
} // namespace bone
