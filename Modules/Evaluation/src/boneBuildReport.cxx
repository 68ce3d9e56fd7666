/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildReport.h"

#include "boneBuildPlan.h"
#include "boneMeshValidator.h"

#include <itkMath.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
constexpr double Degrees = 180.0 / itk::Math::pi;

std::string
Fixed(double value, int digits)
{
  std::ostringstream os;
  os << std::fixed << std::setprecision(digits) << value;
  return os.str();
}

/** Adds a row: a name, and a value for each level. */
void
Row(PageTable &                                             table,
    const BuildReport &                                     report,
    const std::string &                                     name,
    const std::function<std::string(const LevelReport &)> & value)
{
  table.rows.push_back({ name });
  for (const LevelReport & level : report.levels)
  {
    table.rows.back().push_back(value(level));
  }
}

nlohmann::ordered_json
ToJson(const DensityComparison & density)
{
  return { { "voxels", density.voxels },
           { "meanAbsolute", density.meanAbsolute },
           { "bias", density.bias },
           { "range1To99", density.range },
           { "percentOfRange", density.meanAbsolutePercent } };
}

std::string
RegionVolume(const LevelReport & level, int region)
{
  const auto found = level.regionVolumes.find(region);
  return found == level.regionVolumes.end() ? "-" : Fixed(found->second, 0);
}

void
AddSurfaceRows(PageTable & table, const BuildReport & report)
{
  if (report.levels.empty() || !report.levels.front().distances)
  {
    return;
  }
  Row(table, report, "Dice with the label", [](const LevelReport & l) { return Fixed(*l.dice, 4); });
  for (const bool toMask : { true, false })
  {
    const std::string way = toMask ? "mesh to label" : "label to mesh";
    const auto        distance = [toMask](const LevelReport & level) {
      return toMask ? level.distances->meshToMask : level.distances->maskToMesh;
    };
    Row(table, report, way + ", mean (mm)", [&](const LevelReport & l) { return Fixed(distance(l).mean, 3); });
    Row(table, report, way + ", 95 % (mm)", [&](const LevelReport & l) { return Fixed(distance(l).percentile95, 3); });
  }
}

nlohmann::ordered_json
ToJson(const SurfaceDistance & distance)
{
  return { { "mean", distance.mean }, { "percentile95", distance.percentile95 }, { "maximum", distance.maximum } };
}

nlohmann::ordered_json
ToJson(const TilingReport & tiling)
{
  return { { "slabs", tiling.slabs },
           { "branchings", tiling.branchings },
           { "splitBranchings", tiling.splitBranchings },
           { "filledBranchings", tiling.filledBranchings },
           { "splitFillings", tiling.splitFillings },
           { "layerBranchings", tiling.layerBranchings },
           { "caps", tiling.caps },
           { "flatCuts", tiling.flatCuts },
           { "edgesRefined", tiling.edgesRefined },
           { "innerContoursLeftOut", tiling.loopsLeftOut },
           { "holesLeftOut", tiling.holesLeftOut },
           { "axesRecomputed", tiling.axesRecomputed },
           { "otherAxes", tiling.otherAxes },
           { "alternativeKnits", tiling.alternativeKnits },
           { "patches", tiling.patches },
           { "filledSlabs", tiling.filledSlabs },
           { "filledEnds", tiling.filledEnds },
           { "separatedGroups", tiling.separatedGroups } };
}

/** A measure's distribution; `unit` is what its values are multiplied by. The histogram has equal bins over `range`. */
nlohmann::ordered_json
DistributionJson(const QualitySummary & summary, double unit)
{
  return { { "minimum", summary.minimum * unit },
           { "percentile1", summary.percentile1 * unit },
           { "mean", summary.mean * unit },
           { "maximum", summary.maximum * unit },
           { "range", { summary.lower * unit, summary.upper * unit } },
           { "histogram", summary.histogram } };
}

nlohmann::ordered_json
ToJson(const LevelReport & level)
{
  nlohmann::ordered_json json = { { "points", level.points },
                                  { "tetrahedra", level.tetrahedra },
                                  { "valid", level.valid },
                                  { "volumeMm3", level.volume } };
  for (const auto & [region, volume] : level.regionVolumes)
  {
    json["regionVolumesMm3"][std::to_string(region)] = volume;
  }
  json["meanDensity"] = level.meanDensity;
  json["dihedralAngleDegrees"] = DistributionJson(level.dihedral, Degrees);
  json["radiusRatio"] = DistributionJson(level.radiusRatio, 1.0);
  json["scaledJacobian"] = DistributionJson(level.scaledJacobian, 1.0);
  json["edgeRatio"] = DistributionJson(level.edgeRatio, 1.0);
  if (level.distances)
  {
    json["labelDice"] = *level.dice;
    json["meshToLabelMm"] = ToJson(level.distances->meshToMask);
    json["labelToMeshMm"] = ToJson(level.distances->maskToMesh);
  }
  json["densityError"] = ToJson(level.density);
  if (level.spline)
  {
    json["spline"] = { { "tetrahedra", level.spline->tetrahedra },
                       { "coefficients", level.spline->coefficients },
                       { "densityError", ToJson(level.spline->density) } };
  }
  json["radiographDifferencePercent"] = level.radiographPercent;
  json["toLevel1"] = { { "densityErrorRms", level.densityErrorToLevel1 },
                       { "surfaceErrorMm", level.surfaceErrorToLevel1 },
                       { "stopReason", level.stopReason } };
  return json;
}
} // namespace

std::vector<std::string>
FindDoubts(const BuildPlanParameters & plan, const std::vector<LevelReport> & levels)
{
  constexpr double         leastDice = 0.9, share = 0.1;
  std::vector<std::string> doubts;
  if (levels.empty())
  {
    return doubts;
  }
  auto asked = CountTetrahedraOfLevels(plan.levels, static_cast<IdType>(levels[0].tetrahedra));
  asked.insert(asked.begin(), plan.sliceStep > 0.0 && plan.contourSpacing > 0.0 ? 0 : plan.tetrahedra);
  for (std::size_t i = 0; i < levels.size(); ++i)
  {
    const std::string level = "level " + std::to_string(i + 1);
    if (levels[i].dice && !(*levels[i].dice >= leastDice))
    {
      doubts.push_back(level + " overlaps the label with a Dice of " + Fixed(*levels[i].dice, 3) +
                       " only: is the label one bone, and are its slices close enough?");
    }
    const double count = static_cast<double>(levels[i].tetrahedra);
    if (i < asked.size() && asked[i] > 0 && std::abs(count - asked[i]) > share * asked[i])
    {
      doubts.push_back(level + " has " + std::to_string(levels[i].tetrahedra) + " tetrahedra where " +
                       std::to_string(asked[i]) + " were asked for");
    }
  }
  return doubts;
}

LevelReport
DescribeLevel(const MeshArrays & mesh)
{
  LevelReport report;
  report.points = mesh.points.size();
  report.tetrahedra = mesh.tetrahedra.size();
  double mass = 0.0;
  for (const RegionDensity & region : MeasureRegions(mesh))
  {
    report.regionVolumes[region.region] = region.volume;
    report.volume += region.volume;
    mass += region.mass;
  }
  report.meanDensity = report.volume > 0.0 ? mass / report.volume : 0.0;
  report.dihedral = SummarizeQuality(mesh, QualityMeasure::MinimumDihedralAngle);
  report.radiusRatio = SummarizeQuality(mesh, QualityMeasure::RadiusRatio);
  report.scaledJacobian = SummarizeQuality(mesh, QualityMeasure::ScaledJacobian);
  report.edgeRatio = SummarizeQuality(mesh, QualityMeasure::EdgeRatio);
  const MeshValidation validation = ValidateMesh(mesh);
  report.valid = validation.IsValid();
  report.validity = validation.Summary();
  return report;
}

std::string
Headline(const BuildReport & report)
{
  const DensityFitParameters & fit = report.parameters.fit;
  return report.files.image + (report.files.labelName.empty() ? "" : ", " + report.files.labelName) + ": " +
         std::to_string(report.slices) + " slices, on average " + Fixed(report.meanSliceDistance, 2) +
         " mm apart, contour points at most " + Fixed(report.resolution.contourSpacing, 2) + " mm apart, degree " +
         std::to_string(fit.degree) + (fit.continuous ? ", continuous" : "");
}

PageTable
LevelTable(const BuildReport & report)
{
  PageTable table{ "", { "" }, {} };
  for (std::size_t level = 1; level <= report.levels.size(); ++level)
  {
    table.header.push_back("level " + std::to_string(level));
  }
  Row(table, report, "tetrahedra", [](const LevelReport & l) { return std::to_string(l.tetrahedra); });
  Row(table, report, "points", [](const LevelReport & l) { return std::to_string(l.points); });
  Row(table, report, "valid", [](const LevelReport & l) { return std::string(l.valid ? "yes" : "NO"); });
  Row(table, report, "volume (mm^3)", [](const LevelReport & l) { return Fixed(l.volume, 0); });
  for (const int region : { Region::Cortical, Region::Trabecular, Region::Medullary })
  {
    Row(table, report, std::string("  ") + RegionName(region) + " (mm^3)", [region](const LevelReport & l) {
      return RegionVolume(l, region);
    });
  }
  Row(table, report, "dihedral angle, least (deg)", [](const LevelReport & l) {
    return Fixed(l.dihedral.minimum * Degrees, 1);
  });
  Row(table, report, "dihedral angle, mean least (deg)", [](const LevelReport & l) {
    return Fixed(l.dihedral.mean * Degrees, 1);
  });
  AddSurfaceRows(table, report);
  Row(table, report, "mean density", [](const LevelReport & l) { return Fixed(l.meanDensity, 1); });
  Row(table, report, "density error (% of range)", [](const LevelReport & l) {
    return Fixed(l.density.meanAbsolutePercent, 2);
  });
  if (!report.levels.empty() && report.levels.front().spline)
  {
    Row(table, report, "  of its spline (% of range)", [](const LevelReport & l) {
      return Fixed(l.spline->density.meanAbsolutePercent, 2);
    });
  }
  Row(table, report, "radiograph difference (%)", [](const LevelReport & l) { return Fixed(l.radiographPercent, 2); });
  return table;
}

std::string
ToText(const BuildReport & report)
{
  std::ostringstream os;
  const PageTable    table = LevelTable(report);
  const auto         print = [&os](const std::vector<std::string> & row) {
    os << std::left << std::setw(34) << row.front() << std::right;
    std::for_each(row.begin() + 1, row.end(), [&os](const std::string & cell) { os << std::setw(14) << cell; });
    os << '\n';
  };
  os << Headline(report) << "\n\n";
  print(table.header);
  std::for_each(table.rows.begin(), table.rows.end(), print);
  os << "\nseconds:";
  double total = 0.0;
  for (const auto & [name, seconds] : report.times)
  {
    os << ' ' << name << ' ' << Fixed(seconds, 1) << ',';
    total += seconds;
  }
  os << " all " << Fixed(total, 1) << '\n';
  return os.str();
}

std::string
ToJson(const BuildReport & report)
{
  nlohmann::ordered_json json;
  json["version"] = report.version;
  json["input"] = { { "image", report.files.image },         { "series", report.files.series },
                    { "labels", report.files.labels },       { "labelNames", report.files.labelNames },
                    { "labelName", report.files.labelName }, { "initialContours", report.files.initialContours },
                    { "structure", report.files.structure }, { "atlas", report.files.atlas } };
  if (!report.request.empty())
  {
    json["request"] = nlohmann::json::parse(report.request);
  }
  if (!report.bones.empty())
  {
    json["bones"] = report.bones;
  }
  if (!report.registration.empty())
  {
    json["registration"] = nlohmann::json::parse(report.registration);
  }
  json["parameters"] = nlohmann::ordered_json::parse(ToJson(report.parameters));
  json["resolution"] = { { "meanSliceDistanceMm", report.meanSliceDistance },
                         { "askedSliceStepMm", report.resolution.sliceStep },
                         { "contourSpacingMm", report.resolution.contourSpacing } };
  json["slices"] = report.slices;
  json["shareOfTheOutlineBrighterInside"] = report.brighterShare;
  json["tiling"] = ToJson(report.tiling);
  json["levels"] = nlohmann::ordered_json::array();
  for (const LevelReport & level : report.levels)
  {
    json["levels"].push_back(ToJson(level));
  }
  json["warnings"] = report.warnings;
  json["doubts"] = report.doubts;
  for (const auto & [name, seconds] : report.times)
  {
    json["seconds"][name] = seconds;
  }
  for (const auto & [name, bytes] : report.outputs) // last, as a page's size changes with the times in it
  {
    json["outputs"][name] = bytes;
  }
  return json.dump(2) + "\n";
}
} // namespace bone
