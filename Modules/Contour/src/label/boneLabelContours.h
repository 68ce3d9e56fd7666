/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelContours_h
#define boneLabelContours_h

#include "boneSection.h"
#include "boneLabelField.h"

namespace bone
{
/** \brief The pieces of bone of a label in the plane of u, v at a height: smooth contours of the label's field, which
 * enclose the label's area.
 *
 * Smoothing draws in what is thin, so the level is moved (by at most 0.35 of the grid's spacing) until the enclosed
 * area is that of the label. What is so small that its contour nearly vanishes, a voxel or two alone or a hole of that
 * size, gets a level of its own. Contours that enclose less of the label (holes: of what is not) than `minimumArea`
 * (mm^2) are left out and counted in `dropped`. */
std::vector<SectionPiece>
ContoursOfLabel(const LabelField & label,
                const PlaneGrid &  grid,
                const Vector3 &    u,
                const Vector3 &    v,
                double             height,
                double             minimumArea,
                int &              dropped);
} // namespace bone

#endif
