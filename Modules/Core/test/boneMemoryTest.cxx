/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMemory.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <thread>
#include <vector>

#include <unistd.h>

namespace MemoryTests
{
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
/** MB of this process. */
long
Resident()
{
  long        all = 0, resident = 0;
  std::FILE * file = std::fopen("/proc/self/statm", "r");
  EXPECT_NE(file, nullptr);
  EXPECT_EQ(std::fscanf(file, "%ld %ld", &all, &resident), 2);
  std::fclose(file);
  return resident * ::sysconf(_SC_PAGESIZE) / 1000000;
}

TEST(ReturnFreedMemory, GivesBackWhatAnotherThreadHasFreed)
{
  std::vector<char> last; // keeps the thread's store from shrinking by itself
  const long        before = Resident();
  std::thread([&last] {
    std::vector<std::vector<char>> blocks(2000, std::vector<char>(50000, 1));
    last.assign(90000, 1); // above them all
  }).join();
  ASSERT_GT(Resident(), before + 50) << "the C library gives back all by itself: nothing is left to test";
  bone::ReturnFreedMemory();
  EXPECT_LT(Resident(), before + 30);
  EXPECT_EQ(last.size(), 90000u);
}
#endif
} // namespace MemoryTests
