/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneInputOptions_h
#define boneInputOptions_h

#include "boneContourStack.h"
#include "boneLabelChoice.h"
#include "boneSession.h"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace bone
{
/** Adds --series, which DICOM series of a folder is the CT. */
void
AddSeriesOption(CLI::App * command, std::string & series);

/** A CT, or the chosen series of a folder; the session is told what of a folder was passed over. Throws UsageError
 * where a series must be chosen and none was. */
CTImage::Pointer
ReadChosenCT(const std::string & path, const std::string & series, Session & session);

/** The same, read by regions (\ref OpenCT). */
VolumeSource::Pointer
OpenChosenCT(const std::string & path, const std::string & series, Session & session);

/** A label map, or a closed surface, and which of its labels is the bone. */
struct LabelOptions
{
  std::string              file;
  std::vector<std::string> wanted; ///< values, names or patterns of names; none: the only label
  std::string              names;  ///< table of names

  /** Adds --labels, --label and --label-names. */
  CLI::Option *
  AddTo(CLI::App * command, const std::string & help, bool several = false);
};

/** The bones that the options name, on the CT's grid; `ct` may be null, which a surface does not go with. The session
 * is told where a label map was resampled. With `byRegion` a label map on the CT's grid is read as OpenLabelFile has
 * it. Throws UsageError that lists the labels where the bone is not clear. */
std::vector<LabelledBone>
ReadBoneLabels(const LabelOptions & options, const itk::ImageBase<3> * ct, Session & session, bool byRegion = false);

/** The same of one bone. Throws UsageError where a pattern means several. */
LabelledBone
ReadOneBoneLabels(const LabelOptions & options, const itk::ImageBase<3> * ct, Session & session, bool byRegion = false);

/** A label map of one layer on the CT's grid, resampled with a warning where it is not. */
LabelImage::Pointer
ReadLabelsOnGrid(const std::string & path, const itk::ImageBase<3> * ct, Session & session);

/** Where the bone is: a label map, initial contours, or both. */
struct BoneOptions
{
  LabelOptions labels;
  std::string  init;
  std::string  structure;

  /** Adds those of the labels, --init and --structure. */
  void
  AddTo(CLI::App * command, bool several = false);
  /** Throws UsageError where neither labels nor contours were given, or contours for several bones. */
  void
  Verify() const;
};

/** A bone that BoneOptions name, read; labels and contours are null where not given. */
struct BoneInput
{
  LabelledBone          bone;
  ContourStack::Pointer contours;
};

/** `axis` is that of AddAxisOption, `byRegion` that of ReadBoneLabels. */
std::vector<BoneInput>
ReadBones(const BoneOptions & options, unsigned int axis, const CTImage * ct, Session & session, bool byRegion = false);

/** The same of one bone, as \ref ReadOneBoneLabels. */
BoneInput
ReadOneBone(const BoneOptions & options, unsigned int axis, const CTImage * ct, Session & session);
} // namespace bone

#endif
