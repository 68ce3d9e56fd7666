/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourIO_h
#define boneContourIO_h

#include "boneContourStack.h"

#include <string>

namespace bone
{
/** \defgroup ContourIO Contours in VTK's poly-data format, as 3D Slicer markups, label maps and DICOM structure sets
 *
 * Arrays: see the table in the module's README. All functions throw IOError: one line that names the file and what is
 * wrong.
 * \{ */

/** What to take from a file that holds more than one bone, and how it is sliced. */
struct ContourSelection
{
  std::string  structure;  ///< name of a DICOM structure; empty: the only one that has contours
  int          label{ 0 }; ///< value in a label map; 0: every voxel that is not 0
  unsigned int axis{ 2 };  ///< image axis (0, 1, 2) across the slices of a label map
};

/** Reads contours and verifies them (ContourStack::Verify): a contour that crosses itself is refused.
 *
 * A .vtp without the field arrays is read too where each polyline lies in a plane and all planes are parallel: the
 * normal is then that of the contours' areas, its largest component positive, and polylines at one height (within
 * 0.05 mm, or with the same `Slice`) form a slice. Without `Region`, exterior contours that lie inside an odd number of
 * others become holes, and directions of travel follow ContourStack's convention. Lines that end in their first point,
 * and polygons, are closed contours too.
 *
 * .mrk.json: every markup of type ClosedCurve is a contour through its control points (Slicer's spline between them is
 * not followed), exterior unless WriteContours noted its layer; `coordinateSystem` LPS (also where it is missing) and
 * RAS are understood.
 *
 * DICOM RT structure sets (.dcm, or any file with DICOM's mark): the closed planar contours of one structure, read by
 * GDCM. Contours inside others are holes; one that walks to a hole and back by the same way (a keyhole) is taken apart.
 *
 * Any other file is read as a label map: the outlines of the label on each slice that has it, half-way between voxels.
 */
ContourStack::Pointer
ReadContours(const std::string & path, const ContourSelection & selection = {});

/** Writes all of the stack as .vtp, or its closed contours as .mrk.json (in LPS, with layer, region, id and slice as
 * the control points' description; medial axes are left out). The whole file or none. */
void
WriteContours(const ContourStack * stack, const std::string & path);
/** \} */
} // namespace bone

#endif
