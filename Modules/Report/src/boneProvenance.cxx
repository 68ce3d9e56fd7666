/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneProvenance.h"

#include "boneIOError.h"

#include <itksys/MD5.h>
#include <itksys/SystemInformation.hxx>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>

namespace bone
{
namespace
{
/** Adds a file's content to the sum. */
std::uint64_t
AppendFile(const std::filesystem::path & path, itksysMD5 * sum)
{
  std::ifstream     file(path, std::ios::binary);
  std::vector<char> block(1 << 20);
  std::uint64_t     bytes = 0;
  while (file)
  {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    itksysMD5_Append(sum, reinterpret_cast<const unsigned char *>(block.data()), static_cast<int>(file.gcount()));
    bytes += static_cast<std::uint64_t>(file.gcount());
  }
  if (!file.eof())
  {
    throw IOError(path.string(), std::string("cannot be read: ") + std::strerror(errno));
  }
  return bytes;
}
} // namespace

InputFile
DescribeInput(const std::string & path)
{
  InputFile                          input{ path, 0, "" };
  std::vector<std::filesystem::path> files;
  std::error_code                    error;
  if (std::filesystem::is_directory(path, error))
  {
    for (const auto & entry : std::filesystem::directory_iterator(path, error))
    {
      if (entry.is_regular_file(error))
      {
        files.push_back(entry.path());
      }
    }
    std::sort(files.begin(), files.end());
  }
  else
  {
    files.emplace_back(path);
  }
  const std::unique_ptr<itksysMD5, void (*)(itksysMD5 *)> sum(itksysMD5_New(), itksysMD5_Delete);
  itksysMD5_Initialize(sum.get());
  for (const auto & file : files)
  {
    input.bytes += AppendFile(file, sum.get());
  }
  char digits[32];
  itksysMD5_FinalizeHex(sum.get(), digits);
  input.md5.assign(digits, 32);
  return input;
}

std::string
DescribeMachine()
{
  itksys::SystemInformation machine;
  machine.RunCPUCheck();
  machine.RunOSCheck();
  machine.RunMemoryCheck();
  return std::string(machine.GetExtendedProcessorName()) + ", " + std::to_string(machine.GetNumberOfLogicalCPU()) +
         " processors, " + std::to_string(machine.GetTotalPhysicalMemory()) + " MiB, " + machine.GetOSName() + ' ' +
         machine.GetOSRelease();
}

std::string
TimeNow()
{
  const std::time_t now = std::time(nullptr);
  std::tm           parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts);
  return text;
}
} // namespace bone
