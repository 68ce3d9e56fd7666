/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMemory_h
#define boneMemory_h

namespace bone
{
/** Gives the system what this process has freed and the C library keeps for later, one store a thread: after a step of
 * large temporary arrays, before one on other threads. Takes some milliseconds. Does nothing without glibc. */
void
ReturnFreedMemory();
} // namespace bone

#endif
