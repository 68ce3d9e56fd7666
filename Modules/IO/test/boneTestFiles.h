/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneTestFiles_h
#define boneTestFiles_h

#include "boneIOError.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <sys/resource.h>

namespace bone
{
/** A test with an empty folder of its own that is removed afterwards. */
class FileTest : public testing::Test
{
protected:
  void
  SetUp() override
  {
    std::string name = (std::filesystem::temp_directory_path() / "bone-io-test-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    m_Folder = name;
  }
  void
  TearDown() override
  {
    std::filesystem::remove_all(m_Folder);
  }
  std::string
  Path(const std::string & name) const
  {
    return (m_Folder / name).string();
  }
  /** Names of all files, hidden ones too, also in subfolders. */
  std::vector<std::string>
  Files() const
  {
    std::vector<std::string> files;
    for (const auto & entry : std::filesystem::recursive_directory_iterator(m_Folder))
    {
      files.push_back(entry.path().lexically_relative(m_Folder).string());
    }
    std::sort(files.begin(), files.end());
    return files;
  }
  void
  WriteText(const std::string & name, const std::string & text) const
  {
    std::ofstream(Path(name), std::ios::binary) << text;
  }
  std::string
  ReadText(const std::string & name) const
  {
    std::ifstream stream(Path(name), std::ios::binary);
    return { std::istreambuf_iterator<char>(stream), {} };
  }

  std::filesystem::path m_Folder;
};

/** While it lives no file grows beyond so many bytes, as on a full disk. */
class FullDisk
{
public:
  explicit FullDisk(rlim_t bytes)
  {
    m_Handler = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &m_Limit);
    rlimit limit = m_Limit;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk()
  {
    setrlimit(RLIMIT_FSIZE, &m_Limit);
    std::signal(SIGXFSZ, m_Handler);
  }
  FullDisk(const FullDisk &) = delete;
  FullDisk &
  operator=(const FullDisk &) = delete;

private:
  rlimit m_Limit{};
  void (*m_Handler)(int);
};

/** The one line of the IOError that action() throws, with nothing on the standard error stream. */
template <typename TAction>
std::string
ErrorOf(TAction && action)
{
  std::string line = "no IOError was thrown";
  testing::internal::CaptureStderr();
  try
  {
    action();
  }
  catch (const IOError & error)
  {
    line = error.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  EXPECT_EQ(line.find("ITK ERROR"), std::string::npos) << line;
  return line;
}
} // namespace bone

#endif
