/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelCrop_h
#define boneLabelCrop_h

#include "boneImageIO.h"
#include "boneTypes.h"

#include <vector>

namespace bone
{
/** \defgroup LabelCrop A CT and its label map, cut down to one bone
 * Label 0 stands for every value but 0.
 * \{ */

/** Throws itk::ExceptionObject where the two have not the same grid (size; origin, spacing and direction within 1e-3 of
 * a voxel). */
void
VerifySameGrid(const CTImage * ct, const LabelImage * labels);

/** A value of a label map. */
struct LabelCount
{
  int         value{ 0 };
  std::size_t voxels{ 0 };
  double      volume{ 0.0 }; ///< mm^3
};

/** The values there are but 0, ascending. */
std::vector<LabelCount>
CountLabels(const LabelImage * labels);

/** Throws itk::ExceptionObject that lists value, voxels and volume of each label where `label` is 0, there are several
 * and the label map does not state that they are regions of one bone (\ref StatesOneBone): bones are not joined without
 * being told to. */
void
VerifyOneBone(const LabelImage * labels, int label);

/** What a label map says of one bone. */
struct BoneExtent
{
  CTImage::RegionType region;         ///< smallest box of voxels that holds the label
  std::size_t         voxels{ 0 };    ///< of the label
  double              volume{ 0.0 };  ///< mm^3
  double              surface{ 0.0 }; ///< estimate of the label's surface, mm^2 (voxel faces times 2/3)
  bool                leavesImage{ false };
};

/** Throws itk::ExceptionObject that lists the labels there are, where none of the voxels has the label. */
BoneExtent
MeasureLabel(const LabelImage * labels, int label);

/** The region grown by a margin (mm) on every side, as far as the image goes. */
CTImage::RegionType
GrowRegion(const CTImage * image, const CTImage::RegionType & region, double margin);

CTImage::Pointer
Crop(const CTImage * image, const CTImage::RegionType & region);
/** Keeps what the label map states of its labels. */
LabelImage::Pointer
Crop(const LabelImage * image, const CTImage::RegionType & region);

/** 1 where the label is, 0 elsewhere. */
LabelImage::Pointer
MaskOfLabel(const LabelImage * labels, int label);
/** \} */
} // namespace bone

#endif
