/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildParameters_h
#define boneBuildParameters_h

#include "boneContourStackParameters.h"
#include "boneDRRParameters.h"
#include "boneDensityFitParameters.h"
#include "boneMeshQualityParameters.h"
#include "boneMeshStorageParameters.h"
#include "boneSnakeContourParameters.h"
#include "boneTetraCollapseParameters.h"
#include "boneTilingParameters.h"

#include <string>
#include <vector>

namespace bone
{
/** Coarser levels of a build by default, as shares of the first: a fifth and a thirteenth. */
inline std::vector<double>
DefaultLevels()
{
  return { 0.2, 1.0 / 13.0 };
}

// clang-format off
#define BONE_BUILD_PLAN_PARAMETERS(value, flag) \
  value(int, label, Label, 0, ParameterRange::Any(), "", "", \
    "The bone's value in the label map; 0: its only one, or all where the map states that they are regions of one bone") \
  value(unsigned int, axis, Axis, 2, ParameterRange::Between(0, 2), "", "", \
    "Image axis, 0 to 2, that the slices follow one another along") \
  value(IdType, tetrahedra, Tetrahedra, 33000, ParameterRange::Between(500, 1e7), "", "tetrahedra", \
    "Tetrahedra of the first level, about") \
  value(std::vector<double>, levels, Levels, DefaultLevels(), ParameterRange::Positive(), "", "levels", \
    "Coarser levels: numbers of tetrahedra, or shares of the first level") \
  value(double, sliceStep, SliceStep, 0.0, ParameterRange::LengthOrZero(), "mm", "slice-step", \
    "Mean distance of slices, which lie closer where the sections change; 0: chosen for --tetrahedra") \
  flag(regularSlices, RegularSlices, false, "regular-slices", \
    "Slices evenly spaced, --slice-step apart, and not more of them where the sections change") \
  value(double, contourSpacing, ContourSpacing, 0.0, ParameterRange::LengthOrZero(), "mm", "contour-spacing", \
    "Largest distance of a contour's points; 0: chosen for --tetrahedra") \
  value(double, cropMargin, CropMargin, 10.0, ParameterRange::LengthOrZero(), "mm", "margin", \
    "The images are cut down to the label and this margin") \
  value(double, probeStep, ProbeStep, 5.0, ParameterRange::Length(), "mm", "", \
    "Slice step of the contours that tell how large a bone is that has no label map") \
  value(double, largestDistanceBound, LargestDistanceBound, MeshQualityParameters().distanceBound, ParameterRange::LengthOrZero(), "mm", "", \
    "How far the quality stage may move surfaces, half a pixel of the slices at most")
// clang-format on

/** What a build plans with: it sets slice steps, spacings, the distance bound of the quality stage and the numbers of
 * tetrahedra of the levels on the stages. */
BONE_PARAMETER_STRUCT(BuildPlanParameters, BONE_BUILD_PLAN_PARAMETERS);

/** \struct BuildParameters
 * \brief All parameters of a build: those of its plan and those of every stage.
 *
 * The plan overrides, when it is carried out: label and axis of all stages, sliceStep of the contours, meanSpacing of
 * the slices, spacings and tolerance of the resampling, distanceBound of the quality stage, levels of the collapse. */
struct BuildParameters
{
  BuildPlanParameters       plan;
  SnakeContourParameters    contours;
  ContourSliceParameters    slices;
  ContourResampleParameters resample;
  MedialAxisParameters      medialAxis;
  TilingParameters          tiling;
  MeshQualityParameters     quality;
  DensityFitParameters      fit;
  TetraCollapseParameters   collapse;
  DRRParameters             radiograph;
  MeshStorageParameters     storage; ///< of the models' files

  /** Calls visit(name of the stage, its parameters) for each. */
  template <typename TSelf, typename TVisitor>
  static void
  Visit(TSelf & self, TVisitor && visit)
  {
    visit("plan", self.plan);
    visit("contours", self.contours);
    visit("slices", self.slices);
    visit("resample", self.resample);
    visit("medialAxis", self.medialAxis);
    visit("tiling", self.tiling);
    visit("quality", self.quality);
    visit("fit", self.fit);
    visit("collapse", self.collapse);
    visit("radiograph", self.radiograph);
    visit("storage", self.storage);
  }
};

/** What a build read, as its report names it. */
struct BuildFiles
{
  std::string image;           ///< file of the CT, or folder of its DICOM series
  std::string series;          ///< of the folder; empty: its only one
  std::string labels;          ///< empty: none
  std::string labelNames;      ///< table of names; empty: none, or those in the label map
  std::string labelName;       ///< of the bone; empty: the plan's label says it
  std::string initialContours; ///< empty: none
  std::string structure;       ///< of a DICOM structure set; empty: its only one
  std::string atlas;           ///< that finds the bone; empty: none
};

/** A JSON object with an object for each stage, which holds every parameter by its name; numbers are exact, infinity is
 * "inf". */
std::string
ToJson(const BuildParameters & parameters);

/** Reads a file that ToJson wrote, or a build's report.json, which has it as "parameters" and the files read as
 * "input". Parameters that are not in the file are left as they are, and so is `files` where there is no "input".
 * Throws std::runtime_error that names the file and the parameter, for a name that is none and a value that cannot be.
 */
void
ReadBuildParameters(const std::string & path, BuildParameters & parameters, BuildFiles & files);
} // namespace bone

#endif
