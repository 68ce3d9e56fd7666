/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelChoice_h
#define boneLabelChoice_h

#include "boneLabelCrop.h"
#include "boneLabelIO.h"

#include <string>
#include <vector>

namespace bone
{
/** A bone of a label map. */
struct LabelledBone
{
  LabelImage::Pointer labels;
  int                 label{ 0 }; ///< its value there; 0: every value but 0
  std::string         name{};     ///< empty where the file has none
  CTImage::RegionType region{};   ///< smallest box of voxels that holds it; empty where it was not looked for
  /** Of the labels, where they are read by regions: an image does not keep its source. */
  itk::ProcessObject::Pointer source{};
};

/** The labels that a file has, by layer and value, with their names. */
std::vector<LabelCount>
CountLabels(const LabelFile & file);

/** \brief The bones that are wanted, each by its value or its name (whose case may differ where no other has it).
 *
 * A name with * or ?, which no label has as it is, means all labels whose names (or values, where they have none) match
 * it, whatever their case, in the file's order: "rib_*", or "*" for all.
 *
 * None wanted: the only label there is, or all where the map states that they are regions of one bone
 * (\ref StatesOneBone). Throws itk::ExceptionObject that lists the labels where none was named of several, one that is
 * wanted is not there, or is not the only one of its name or, in several layers, of its value. */
std::vector<LabelledBone>
ChooseBones(const LabelFile & file, const std::vector<std::string> & wanted);
} // namespace bone

#endif
