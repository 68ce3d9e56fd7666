/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMeasureOptions_h
#define boneMeasureOptions_h

#include "boneMeasureReport.h"
#include "boneSession.h"

#include <string>
#include <vector>

namespace bone
{
/** The mesh of a .vtu, or the first level of a .hierarchy.json. */
MeshArrays
ReadFirstLevel(const std::string & path);

/** Throws UsageError where an option's numbers are no multiple of `each`. */
void
RequireNumbersEach(const char * option, const std::vector<double> & numbers, std::size_t each);

/** A line for each measure, and for each that is missing. */
void
PrintMeasures(const MeasureReport & report, Session & session);
} // namespace bone

#endif
