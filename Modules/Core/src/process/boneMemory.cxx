/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneMemory.h"

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace bone
{
void
ReturnFreedMemory()
{
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}
} // namespace bone
