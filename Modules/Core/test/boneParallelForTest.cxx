/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneParallelFor.h"

#include <gtest/gtest.h>

#include <vector>

TEST(ParallelFor, CallsTheBodyOnceForEach)
{
  for (const std::size_t count : { 0u, 1u, 255u, 256u, 257u, 5000u })
  {
    std::vector<int> calls(count, 0);
    bone::ParallelFor(count, [&](std::size_t i) { ++calls[i]; });
    EXPECT_EQ(calls, std::vector<int>(count, 1));
  }
}
