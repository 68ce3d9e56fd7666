/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneParallelFor_h
#define boneParallelFor_h

#include <itkMultiThreaderBase.h>

#include <cstddef>

namespace bone
{
/** Calls body(i) for i from 0 to count - 1 on ITK's threads, in any order: what it writes must be its own. In blocks,
 * as a body may be short. */
template <typename TBody>
void
ParallelFor(std::size_t count, TBody body)
{
  constexpr std::size_t block = 256;
  itk::MultiThreaderBase::New()->ParallelizeArray(
    0,
    (count + block - 1) / block,
    [&](itk::SizeValueType b) {
      for (std::size_t i = b * block; i < count && i < (b + 1) * block; ++i)
      {
        body(i);
      }
    },
    nullptr);
}
} // namespace bone

#endif
