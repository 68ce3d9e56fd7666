/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneBuildReport_h
#define boneBuildReport_h

#include "boneMeshImageMetrics.h"
#include "boneQualityMeasures.h"
#include "boneReportPage.h"
#include "boneResolution.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace bone
{
/** A level's density with a continuous gradient (BuildPipeline::GetSpline). */
struct SplineReport
{
  std::size_t       tetrahedra{ 0 };   ///< of the split mesh
  std::size_t       coefficients{ 0 }; ///< of the spline's own basis
  DensityComparison density;
};

/** What is to be known of one level of a built model. */
struct LevelReport
{
  std::size_t           points{ 0 };
  std::size_t           tetrahedra{ 0 };
  double                volume{ 0.0 }; ///< mm^3
  std::map<int, double> regionVolumes; ///< mm^3 by region
  double                meanDensity{ 0.0 };
  QualitySummary        dihedral; ///< smallest dihedral angle of each tetrahedron, rad
  QualitySummary        radiusRatio;
  QualitySummary        scaledJacobian;
  QualitySummary        edgeRatio;
  bool                  valid{ false };
  std::string           validity;                    ///< "valid", or the first failed check
  double                densityErrorToLevel1{ 0.0 }; ///< root mean square, density units
  double                surfaceErrorToLevel1{ 0.0 }; ///< mm
  std::string           stopReason;

  std::optional<double>           dice;      ///< with a label map only
  std::optional<SurfaceDistances> distances; ///< with a label map only
  DensityComparison               density;
  double                          radiographPercent{ 0.0 };
  std::optional<SplineReport>     spline; ///< with a continuous gradient only
};

/** What is to be known of a build. */
struct BuildReport
{
  std::string              version;
  BuildFiles               files;
  std::string              request;      ///< what was asked for, as JSON, by which a repetition is known; may be empty
  std::vector<std::string> bones;        ///< folders of those that were asked for together, this one too; none of one
  std::string              registration; ///< of the atlas that found the bone, as JSON; empty without one
  BuildParameters          parameters;   ///< of the plan as asked for, of the stages as they ran
  Resolution               resolution;
  std::size_t              slices{ 0 };
  double                   meanSliceDistance{ 0.0 }; ///< mm, between the slices kept
  double                   brighterShare{ 1.0 };     ///< of the bone's outline in the CT, see \ref OutlineContrast
  TilingReport             tiling;
  std::vector<LevelReport> levels;
  std::vector<std::string> warnings;
  std::vector<std::string> doubts; ///< those of the warnings by which the input may be a wrong one
  /** The files beside the report, with their bytes. */
  std::vector<std::pair<std::string, std::uintmax_t>> outputs;
  /** Seconds by step, in order. */
  std::vector<std::pair<std::string, double>> times;
};

/** Counts, volumes, validity and quality of a level's mesh; the rest is left to the caller. */
LevelReport
DescribeLevel(const MeshArrays & mesh);

/** Where a build is not what was asked for, a sentence each: a Dice overlap with the label below 0.9; a number of
 * tetrahedra more than a tenth from the plan's, which is not sought where the plan gives both slice step and spacing.
 */
std::vector<std::string>
FindDoubts(const BuildPlanParameters & plan, const std::vector<LevelReport> & levels);

/** The bone and how it was built, in a line. */
std::string
Headline(const BuildReport & report);

/** The levels' figures, a column a level. */
PageTable
LevelTable(const BuildReport & report);

/** The report as text. */
std::string
ToText(const BuildReport & report);

/** The report as JSON. */
std::string
ToJson(const BuildReport & report);
} // namespace bone

#endif
