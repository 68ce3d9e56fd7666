/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelCrop_h
#define boneLabelCrop_h

#include "boneImageIO.h"
#include "boneTypes.h"

#include <string>
#include <vector>

namespace bone
{
/** \defgroup LabelCrop A CT and its label map, cut down to one bone
 * Label 0 stands for every value but 0.
 * \{ */

/** How far apart the corners of two grids may lie that count as one, in parts of the smallest voxel edge: files round
 * positions. */
constexpr double GridTolerance = 1e-2;

/** Whether two images have the same size, and their corner voxels the same places within \ref GridTolerance. */
bool
IsSameGrid(const itk::ImageBase<3> * a, const itk::ImageBase<3> * b);

/** The label map with the CT's own origin, spacing and direction, so that no stage finds a difference; voxels are
 * shared. Throws itk::ExceptionObject where the two have not the same grid. */
LabelImage::Pointer
PutOnGrid(const LabelImage * labels, const itk::ImageBase<3> * ct);

/** The label of the nearest voxel at each voxel of the CT. Throws itk::ExceptionObject where the label map does not
 * cover the CT. */
LabelImage::Pointer
ResampleToGrid(const LabelImage * labels, const itk::ImageBase<3> * ct);

/** A value of a label map. */
struct LabelCount
{
  int                 value{ 0 };
  std::size_t         voxels{ 0 };
  double              volume{ 0.0 }; ///< mm^3
  std::string         name{};        ///< empty where it has none
  CTImage::RegionType region{};      ///< smallest box of voxels that holds it
};

/** The values there are but 0, ascending, without names. What is read by regions (\ref OpenLabelFile) is read slab by
 * slab. */
std::vector<LabelCount>
CountLabels(const LabelImage * labels);

/** "1 'femur_left' (8000 voxels, 8.0 cm^3), 2 (...)": the first twenty. */
std::string
ListLabels(const std::vector<LabelCount> & labels);

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
GrowRegion(const itk::ImageBase<3> * image, const CTImage::RegionType & region, double margin);

CTImage::Pointer
Crop(const CTImage * image, const CTImage::RegionType & region);
/** Keeps what the label map states of its labels. */
LabelImage::Pointer
Crop(const LabelImage * image, const CTImage::RegionType & region);

/** Makes voxels of other labels 0; with label 0, none. */
void
RemoveOtherLabels(int label, LabelImage * labels);

/** 1 where the label is, 0 elsewhere. */
LabelImage::Pointer
MaskOfLabel(const LabelImage * labels, int label);
/** \} */
} // namespace bone

#endif
