/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneContourImage_h
#define boneContourImage_h

#include "boneContourStack.h"
#include "boneImageIO.h"

namespace bone
{
/** \defgroup ContourImage Contours to label maps and back
 * \{ */

/** A label map on the grid of `grid`: a voxel has the region (1 cortical, 2 trabecular, 3 medullary; 0 outside) that
 * its centre has on the nearest of the stack's slices, none beyond half a step past the first and the last. The grid
 * may lie obliquely to the slices. */
LabelImage::Pointer
RasterizeContours(const ContourStack * stack, const itk::ImageBase<3> * grid);

/** The periosteal contours of a label (0: every voxel that is not 0) on each slice across `axis` that has it, holes
 * too, half-way between voxels inside and outside. Throws itk::ExceptionObject where no voxel has the label. */
ContourStack::Pointer
TraceLabels(const LabelImage * labels, int label, unsigned int axis);
/** \} */
} // namespace bone

#endif
