/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneMarkups_h
#define boneMarkups_h

#include "bonePolylines.h"

#include <string>

namespace bone
{
/** The closed curves of a 3D Slicer markups file, in LPS. Throws IOError. */
std::vector<Polyline>
ReadMarkups(const std::string & path);

/** The stack's closed contours as a 3D Slicer markups document, in LPS. */
std::string
ToMarkups(const ContourStack & stack);
} // namespace bone

#endif
