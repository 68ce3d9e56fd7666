/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneSurfaceLabels_h
#define boneSurfaceLabels_h

#include "boneImageIO.h"
#include "boneTriangleSurface.h"

namespace bone
{
/** A label map on the grid of `grid`: 1 where a voxel's centre lies inside the closed surface (mm, LPS), by VTK's
 * stencil, else 0. */
LabelImage::Pointer
LabelsOfSurface(const TriangleSurface & surface, const itk::ImageBase<3> * grid);
} // namespace bone

#endif
