/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildPage.h"

#include "boneChart.h"
#include "boneDensityEvaluation.h"
#include "bonePageData.h"

#include <itkMath.h>

#include <filesystem>

namespace bone
{
namespace
{
std::string
NameOfBone(const BuildFiles & files)
{
  if (!files.labelName.empty())
  {
    return files.labelName;
  }
  return std::filesystem::path(files.image).filename().string();
}

std::string
LevelTitle(std::size_t level, const MeshArrays & mesh)
{
  return "level " + std::to_string(level + 1) + ", " + std::to_string(mesh.tetrahedra.size()) + " tetrahedra";
}

std::vector<std::string>
SliceTitles(const Evidence & evidence, const ContourStack & stack)
{
  const itk::ImageBase<3> * whole = evidence.whole.IsNull() ? evidence.ct.GetPointer() : evidence.whole.GetPointer();
  std::vector<std::string>  titles;
  for (const ContourSlice & slice : stack.GetSlices())
  {
    titles.push_back(DescribeSlice(whole, stack.GetNormal(), slice.origin));
  }
  return titles;
}

void
AddChart(const Chart & chart, const std::string & description, ReportPage & page)
{
  page.AddPicture(DrawChart(chart).GetSvg(), description, description);
}

void
AddDensityCharts(const BuildReport & report, const std::vector<double> & lowerDegrees, ReportPage & page)
{
  Chart degrees;
  degrees.x.label = "degree";
  degrees.y.label = "mean absolute error (% of range)";
  degrees.y.lower = 0.0;
  degrees.series.push_back({ "level 1", {} });
  auto & points = degrees.series[0].points;
  for (const double error : lowerDegrees)
  {
    points.push_back({ static_cast<double>(points.size()), error });
  }
  points.push_back({ static_cast<double>(points.size()), report.levels.front().density.meanAbsolutePercent });
  AddChart(
    degrees,
    "Density error of level 1 to the CT where each tetrahedron's polynomial is cut to a degree: its nearest one of "
    "that degree",
    page);
  Chart levels;
  levels.x.label = "tetrahedra";
  levels.x.log = report.levels.size() > 1;
  levels.y.label = "error or difference (%)";
  levels.y.lower = 0.0;
  levels.series.push_back({ "density, % of the CT's range", {} });
  levels.series.push_back({ "radiograph, % of its range", {} });
  for (const LevelReport & level : report.levels)
  {
    const auto count = static_cast<double>(level.tetrahedra);
    levels.series[0].points.push_back({ count, level.density.meanAbsolutePercent });
    levels.series[1].points.push_back({ count, level.radiographPercent });
  }
  AddChart(levels, "Error of density and radiograph of each level", page);
}

/** Shares of a level's cells by the bins of a measure. */
ChartSeries
Distribution(const std::string & name, const QualitySummary & summary, double unit)
{
  ChartSeries series;
  series.name = name;
  series.markers = false;
  double all = 0.0;
  for (const auto count : summary.histogram)
  {
    all += static_cast<double>(count);
  }
  const double width = (summary.upper - summary.lower) / static_cast<double>(summary.histogram.size());
  for (std::size_t k = 0; k < summary.histogram.size(); ++k)
  {
    series.points.push_back({ unit * (summary.lower + (static_cast<double>(k) + 0.5) * width),
                              100.0 * static_cast<double>(summary.histogram[k]) / std::max(1.0, all) });
  }
  return series;
}

void
AddQualityCharts(const BuildReport & report, ReportPage & page)
{
  Chart angles, ratios;
  angles.x.label = "least dihedral angle (degrees)";
  ratios.x.label = "scaled Jacobian";
  angles.y.label = ratios.y.label = "tetrahedra (%)";
  angles.y.lower = ratios.y.lower = 0.0;
  for (std::size_t i = 0; i < report.levels.size(); ++i)
  {
    const std::string name = "level " + std::to_string(i + 1);
    angles.series.push_back(Distribution(name, report.levels[i].dihedral, 180.0 / itk::Math::pi));
    ratios.series.push_back(Distribution(name, report.levels[i].scaledJacobian, 1.0));
  }
  AddChart(angles, "Least dihedral angle of the tetrahedra; a regular one has 70.5 degrees", page);
  AddChart(ratios, "Scaled Jacobian of the tetrahedra; a regular one has 1", page);
}
} // namespace

BuildPageParts
PackPageParts(const Evidence & evidence, const ContourStack & stack, const MeshArrays & finest, const Window & window)
{
  const std::string unit = DensityUnitName(finest.quantity);
  return { PackLevel(LevelTitle(0, finest), finest, PictureStep(finest)),
           PackSlices(evidence.ct, stack, window, unit, SliceTitles(evidence, stack)),
           {} };
}

ReportPage
MakeBuildPage(const BuildReport & report, const Evaluation & evaluation, BuildPipeline & pipeline)
{
  const BuildPageParts & parts = evaluation.page.value();
  ReportPage             page(NameOfBone(report.files), "build");
  page.SetWarnings(report.warnings);
  const auto &            levels = pipeline.GetHierarchy()->GetLevels();
  const ContourStack *    stack = pipeline.GetContours();
  std::vector<MeshArrays> meshes;
  for (const auto & level : levels)
  {
    meshes.push_back(level.mesh->GetArrays());
  }
  std::vector<NamedMesh> named;
  for (std::size_t i = 0; i < meshes.size(); ++i)
  {
    named.push_back({ LevelTitle(i, meshes[i]), &meshes[i] });
  }
  page.BeginSection("model", "Model");
  page.AddModel(PackModel(named, stack, {}, parts.finest));
  page.BeginSection("levels", "Levels");
  page.AddText(Headline(report) + ".");
  page.AddTable(LevelTable(report));
  page.BeginSection("contours", "CT slices");
  page.AddSlices(parts.slices);
  page.AddPicture(evaluation.slices.jpeg,
                  "CT slices over the length of the bone with its contours",
                  "Slices of the CT with the contours the model was made from");
  page.BeginSection("cut-plane", "Cut plane");
  page.AddPicture(evaluation.cutPlane.jpeg,
                  "CT, levels of the model and their differences on a plane along the bone",
                  "The CT and the levels of the model on the plane along which the bone extends most");
  page.BeginSection("radiographs", "Radiographs");
  page.AddPicture(evaluation.radiographs.jpeg,
                  "Radiographs of the CT and of the levels, and their differences",
                  "Line integrals of density: those of the CT count the bone's voxels alone");
  page.BeginSection("density", "Density");
  AddDensityCharts(report, parts.lowerDegrees, page);
  page.BeginSection("quality", "Quality of the tetrahedra");
  AddQualityCharts(report, page);
  return page;
}
} // namespace bone
