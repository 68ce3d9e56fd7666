/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLargeArray.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <numeric>

using namespace bone;

TEST(LargeArray, KeepsItsNumbersWhereItGrows)
{
  LargeArray<double> numbers(100);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  numbers.resize(1000000);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers.data()) % (std::uintptr_t{ 1 } << 21), 0u);
  std::iota(numbers.begin() + 100, numbers.end(), 100.0);
  LargeArray<double> expected(numbers.size());
  std::iota(expected.begin(), expected.end(), 0.0);
  EXPECT_EQ(numbers, expected);
}

TEST(LargeArray, SaysThatThereIsNotEnoughMemory)
{
  EXPECT_THROW(AllocateLarge(std::numeric_limits<std::size_t>::max() / 4), std::bad_alloc);
  EXPECT_THROW(AllocateLarge(std::numeric_limits<std::size_t>::max()), std::bad_alloc);
}
