/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLoopRunner_h
#define boneLoopRunner_h

#include <cstddef>
#include <functional>

namespace bone
{
/** Calls body(i) for each i in [0, count), in any order and perhaps at once; body writes what belongs to i alone. */
using ParallelFor = std::function<void(std::size_t count, const std::function<void(std::size_t)> & body)>;

/** How a kernel's loops are run. */
struct LoopRunner
{
  ParallelFor prepare; ///< short loops before the main one
  ParallelFor draw;    ///< the main loop, called once: the one to report progress of
};

} // namespace bone

#endif
