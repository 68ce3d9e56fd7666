/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneLabelIO_h
#define boneLabelIO_h

#include "boneImageIO.h"

#include <string>
#include <vector>

namespace bone
{
/** \defgroup LabelIO Label maps with the names of their labels
 * All functions throw IOError: one line that names the file, what is wrong and what to do.
 * \{ */

/** What a file calls one of its labels. */
struct LabelName
{
  std::size_t layer{ 0 }; ///< of a file whose labels overlap
  int         value{ 0 };
  std::string name;
};

/** A label map as its file has it. Segments of 3D Slicer may overlap: such a .seg.nrrd has several layers, each a label
 * map of its own on the same grid. */
struct LabelFile
{
  std::vector<LabelImage::Pointer> layers; ///< one at least
  std::vector<LabelName>           names;  ///< empty where the file names none
  /** Of the layer, where it is read by regions: an image does not keep its source. */
  itk::ProcessObject::Pointer source;
};

/** Reads a label map, with several layers too; see ReadLabels for what is refused. */
LabelFile
ReadLabelFile(const std::string & path);

/** The same, of which a file of one layer is read where a filter asks for it, as OpenCT has it. That a voxel is no
 * label is found when it is read. */
LabelFile
OpenLabelFile(const std::string & path);

/** The names in the header of a label map alone: the segments of a .seg.nrrd of 3D Slicer (Segment0_Name, ...), or the
 * label table in a NIfTI file's extension, as TotalSegmentator and Connectome Workbench write it. None where the file
 * has none. */
std::vector<LabelName>
ReadLabelNames(const std::string & path);

/** A table of label names in a file of its own: lines of a value and a name, apart by blanks, a tab, a comma or a bar
 * (colour tables of 3D Slicer and ITK-SNAP, .csv; a first line without a value is a heading), or a JSON object of
 * values and names in either order, which may be the member "labels" (nnU-Net's dataset.json). The background, 0, is
 * left out.
 */
std::vector<LabelName>
ReadLabelTable(const std::string & path);
/** \} */
} // namespace bone

#endif
