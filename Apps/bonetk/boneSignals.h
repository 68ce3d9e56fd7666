/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSignals_h
#define boneSignals_h

namespace bone
{
/** From here on SIGINT, SIGTERM, SIGHUP and SIGQUIT remove the temporaries of all outputs and end the process, with 130
 * for SIGINT and 1 for the others; a file too large for the user's limit, and a pipe that nobody reads any more, are
 * errors of the write and no signals. Call it before the first thread starts. */
void
InstallSignalHandling();
} // namespace bone

#endif
