/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneCorrespondenceIO_h
#define boneCorrespondenceIO_h

#include "boneContourCorrespondence.h"

#include <string>

namespace bone
{
/** \defgroup CorrespondenceIO Correspondence of contours as JSON
 *
 * \code{.json}
 * {"slabs": [{"slice": 12, "groups": [{"lower": [0, 3], "upper": [0]}, {"lower": [], "upper": [2]}]}]}
 * \endcode
 * `slice` is the lower of the two slices, numbers in groups are ids of periosteal contours (array `Contour` of a contour
 * file). Slabs that are not there are left to the tiling, pieces that are in no group end or begin at their slice.
 * \{ */

/** Throws IOError where the file is missing or no JSON, or a member is missing, unknown or not usable. */
ContourCorrespondence
ReadCorrespondence(const std::string & path);

/** Writes the whole file or none. */
void
WriteCorrespondence(const ContourCorrespondence & correspondence, const std::string & path);
/** \} */
} // namespace bone

#endif
