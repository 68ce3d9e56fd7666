/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourIO_h
#define boneContourIO_h

#include "boneContourStack.h"

#include <string>

namespace bone
{
/** \defgroup ContourIO Contours in VTK's poly-data format (.vtp) and as 3D Slicer markups (.mrk.json)
 *
 * Arrays: see the table in the module's README. All functions throw IOError: one line that names the file and what is
 * wrong.
 * \{ */

/** Reads contours and verifies them (ContourStack::Verify): a contour that crosses itself is refused.
 *
 * A .vtp without the field arrays is read too where each polyline lies in a plane and all planes are parallel: the
 * normal is then that of the contours' areas, its largest component positive, and polylines at one height (within
 * 0.05 mm, or with the same `Slice`) form a slice. Without `Region`, exterior contours that lie inside an odd number of
 * others become holes, and directions of travel follow ContourStack's convention. Lines that end in their first point,
 * and polygons, are closed contours too.
 *
 * .mrk.json: every markup of type ClosedCurve is an exterior contour through its control points (Slicer's spline
 * between them is not followed); `coordinateSystem` LPS (also where it is missing) and RAS are understood. */
ContourStack::Pointer
ReadContours(const std::string & path);

/** Writes all of the stack as .vtp, the whole file or none. */
void
WriteContours(const ContourStack * stack, const std::string & path);
/** \} */
} // namespace bone

#endif
