/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLargeArray.h"

#include <cstdlib>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace bone
{
void *
AllocateLarge(std::size_t bytes)
{
  constexpr std::size_t line = 64, page = std::size_t{ 1 } << 21;
  const bool            isLarge = bytes >= page;
  const std::size_t     alignment = isLarge ? page : line;
  const std::size_t     whole = (bytes + alignment - 1) / alignment * alignment;
  void * const          memory = whole < bytes ? nullptr : std::aligned_alloc(alignment, whole);
  if (memory == nullptr)
  {
    throw std::bad_alloc();
  }
#ifdef __linux__
  if (isLarge)
  {
    madvise(memory, whole, MADV_HUGEPAGE); // advice: where it is not taken, pages are small
  }
#endif
  return memory;
}

void
FreeLarge(void * memory) noexcept
{
  std::free(memory);
}
} // namespace bone
