/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneParallelLoop_h
#define boneParallelLoop_h

#include <itkMultiThreaderBase.h>

#include <algorithm>
#include <cstddef>

namespace bone
{
/** body(i) for each i in [0, count), on all threads, `chunk` at a time; body writes what belongs to i alone. */
template <typename TBody>
void
ParallelLoop(std::size_t count, std::size_t chunk, const TBody & body)
{
  itk::MultiThreaderBase::New()->ParallelizeArray(
    0,
    (count + chunk - 1) / chunk,
    [&](itk::SizeValueType c) {
      for (std::size_t i = c * chunk; i < std::min(count, (c + 1) * chunk); ++i)
      {
        body(i);
      }
    },
    nullptr);
}
} // namespace bone

#endif
