/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLargeArray_h
#define boneLargeArray_h

#include <cstddef>
#include <new>
#include <vector>

namespace bone
{
/** Memory for LargeArray. Throws std::bad_alloc. */
void *
AllocateLarge(std::size_t bytes);
void
FreeLarge(void * memory) noexcept;

/** \class LargeAllocator
 * \brief Of numbers that are written before they are read: they begin without a value, in pages of 2 MB where the
 * system has them.
 *
 * To make a process's memory ready takes the system about 2 microseconds a page, of which there are else 256 for 1 MB.
 */
template <typename T>
struct LargeAllocator
{
  using value_type = T;

  LargeAllocator() = default;
  template <typename TOther>
  LargeAllocator(const LargeAllocator<TOther> &)
  {}

  T *
  allocate(std::size_t count)
  {
    return static_cast<T *>(AllocateLarge(count * sizeof(T)));
  }
  void
  deallocate(T * memory, std::size_t) noexcept
  {
    FreeLarge(memory);
  }
  template <typename TValue>
  void
  construct(TValue * at)
  {
    ::new (static_cast<void *>(at)) TValue;
  }

  friend bool
  operator==(const LargeAllocator &, const LargeAllocator &)
  {
    return true;
  }
  friend bool
  operator!=(const LargeAllocator &, const LargeAllocator &)
  {
    return false;
  }
};

/** A std::vector of numbers whose resize() leaves them without a value. */
template <typename T>
using LargeArray = std::vector<T, LargeAllocator<T>>;
} // namespace bone

#endif
