/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneOwnOrientation_h
#define boneOwnOrientation_h

#include "boneImageIO.h"

#include <array>

namespace bone
{
/** \defgroup OwnOrientation A bone in the orientation of its own
 * The order of an image's voxels is the scanner's affair. Stages see each bone's voxels in the order in which its
 * longer tail is at the end of each axis, and in the coordinates of this grid, so that a bone and its mirror image, or
 * the same bone in another order of voxels, give the same model but for the place.
 * \{ */
/** The axes along which the voxels of a bone must change their order: where the third central moment of the mask's
 * voxels is negative, or, where it vanishes, that of the CT's values in the mask. None where both vanish. */
std::array<bool, 3>
FindFlips(const CTImage * ct, const LabelImage * mask);

/** The same voxels at the same places, in the other order along some axes; the image itself where there is none. */
CTImage::Pointer
Flip(const CTImage::Pointer & image, const std::array<bool, 3> & axes);
/** Keeps what the label map states of its labels. */
LabelImage::Pointer
Flip(const LabelImage::Pointer & image, const std::array<bool, 3> & axes);

/** The same voxels, not copied, on a grid whose first voxel is at the origin and whose axes are those of space:
 * PlacementOf(image) takes it to its place. Brings the image up to date. Null for null. */
CTImage::Pointer
OnOwnGrid(const CTImage * image);
LabelImage::Pointer
OnOwnGrid(const LabelImage * image);
/** \} */
} // namespace bone

#endif
