/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneStructureSet_h
#define boneStructureSet_h

#include "bonePolylines.h"

#include <string>

namespace bone
{
/** The closed planar contours of one structure of a DICOM RT structure set, in LPS; see ReadContours. Throws
 * itk::ExceptionObject. */
std::vector<Polyline>
ReadStructure(const std::string & path, const std::string & name);

/** A walk around a region that reaches its holes by ways it goes twice, there and back, taken apart into closed
 * contours; any other contour is returned as it is. */
std::vector<std::vector<Vector3>>
TakeKeyholesApart(std::vector<Vector3> contour);
} // namespace bone

#endif
