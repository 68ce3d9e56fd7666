/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildEvaluation.h"

#include "boneBuildPlan.h"
#include "boneDensityEvaluation.h"
#include "boneDensityImageFilter.h"
#include "boneTicks.h"
#include "boneVoxelDRRImageFilter.h"
#include "boneXRayPicture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace bone
{
namespace
{
using MeshType = BuildPipeline::MeshType;

/** The model's density at the voxels of an image, NaN outside the model. */
CTImage::Pointer
Voxelize(const MeshType * mesh, const CTImage * reference)
{
  auto filter = DensityImageFilter<MeshType, CTImage>::New();
  filter->SetInput(mesh);
  filter->SetReferenceImage(reference);
  filter->SetOutsideValue(std::numeric_limits<float>::quiet_NaN());
  filter->Update();
  return filter->GetOutput();
}

CTImage::Pointer
RadiographOfCT(const CTImage * ct, const LabelImage * mask, const XRayGeometry * geometry)
{
  auto filter = VoxelDRRImageFilter<CTImage, CTImage>::New();
  filter->SetInput(ct);
  filter->SetMask(mask);
  filter->SetGeometry(geometry);
  filter->Update();
  return filter->GetOutput();
}

std::string
LevelName(std::size_t level, const LevelReport & report)
{
  return "level " + std::to_string(level + 1) + ": " + std::to_string(report.tetrahedra) + " tetrahedra";
}

/** One view of the radiographs. */
struct RadiographPanels
{
  XRayGeometry::ConstPointer geometry;
  CTImage::Pointer           reference; ///< of the CT
  std::vector<LevelPanel>    levels;
};

/** A level's radiograph in another view than the pipeline's. */
CTImage::Pointer
RadiographOfLevel(const MeshType * mesh, const XRayGeometry * geometry, const BuildPipeline::RadiographType & like)
{
  auto filter = BuildPipeline::RadiographType::New();
  filter->SetInput(mesh);
  filter->SetParameters(like.GetParameters());
  filter->SetParameters(like.GetRadiographParameters());
  filter->SetGeometry(geometry);
  filter->Update();
  return filter->GetOutput();
}

Comparison
CompareRadiographs(const RadiographPanels & panels, const Vector3 & centre, const std::string & unit)
{
  const auto & view = panels.geometry->GetView();
  Comparison   comparison;
  comparison.title = DescribeView(view);
  comparison.letters = LettersOf(view);
  comparison.pixelSize = PixelSizeAt(view, centre);
  comparison.scaleNote = "at the bone";
  comparison.reference = ToPanel(panels.reference);
  comparison.levels = panels.levels;
  const auto & values = comparison.reference.values;
  const double largest = *std::max_element(values.begin(), values.end());
  comparison.window = { 0.0, RoundInRange(0.9 * largest, largest) };
  comparison.scale = RoundInRange(0.1 * largest, largest);
  comparison.unit = unit;
  return comparison;
}

Comparison
CompareCut(const PlaneView & cut, const CTImage * ct, std::vector<LevelPanel> levels, const Window & window)
{
  Comparison    comparison;
  const Vector3 middle = cut.corner + 0.5 * cut.pixel * ((cut.columns - 1.0) * cut.right + (cut.rows - 1.0) * cut.down);
  comparison.title = DescribePlane(cut.right.cross(cut.down), middle);
  comparison.letters = cut.Letters();
  comparison.pixelSize = Vector2::Constant(cut.pixel);
  comparison.reference = SamplePlane(ct, cut);
  comparison.levels = std::move(levels);
  comparison.window = window;
  return comparison;
}

Vector3
MeanOf(const std::vector<Vector3> & points)
{
  Vector3 sum = Vector3::Zero();
  for (const Vector3 & p : points)
  {
    sum += p;
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, points.size()));
}
} // namespace

Evaluation
Evaluate(BuildPipeline & pipeline, const Evidence & evidence)
{
  const auto & levels = pipeline.GetHierarchy()->GetLevels();
  const auto   finest = levels.front().mesh->GetArrays();
  Evaluation   evaluation;

  LabelImage::ConstPointer mask = evidence.mask;
  if (mask.IsNull())
  {
    mask = MaskOfMesh(finest, evidence.ct);
  }
  // First, and by themselves: they take a copy of the CT for a time.
  RadiographPanels front, side;
  pipeline.GetRadiograph(0)->Update();
  front.geometry = pipeline.GetRadiograph(0)->GetGeometry();
  side.geometry = LateralView(levels.front().mesh);
  for (RadiographPanels * panels : { &front, &side })
  {
    panels->reference = RadiographOfCT(evidence.ct, mask, panels->geometry);
  }
  const PlaneView         cut = FrameLargestCut(finest.points, 5.0, 420);
  std::vector<LevelPanel> cuts;
  const auto distances = evidence.mask ? std::make_optional<SurfaceDistanceMeter>(evidence.mask) : std::nullopt;
  for (std::size_t i = 0; i < levels.size(); ++i)
  {
    const MeshType * mesh = levels[i].mesh;
    const MeshArrays arrays = mesh->GetArrays();
    LevelReport      report = DescribeLevel(arrays);
    report.densityErrorToLevel1 = levels[i].densityError;
    report.surfaceErrorToLevel1 = levels[i].surfaceError;
    report.stopReason = levels[i].stopReason;
    if (evidence.mask.IsNotNull())
    {
      report.dice = DiceOverlap(arrays, mask);
      report.distances = distances->Measure(arrays);
    }
    report.density = CompareWithImage(arrays, evidence.ct, mask);
    if (const auto spline = pipeline.GetSpline(i))
    {
      report.spline = { static_cast<std::size_t>(spline->GetNumberOfTetrahedra()),
                        pipeline.GetSplineFit(i)->GetNumberOfFreeCoefficients(),
                        CompareWithImage(spline->GetArrays(), evidence.ct, mask) };
    }

    BuildPipeline::RadiographType * radiograph = pipeline.GetRadiograph(i);
    radiograph->Update();
    report.radiographPercent = RadiographDifferencePercent(front.reference, radiograph->GetOutput());
    const std::string name = LevelName(i, report);
    front.levels.push_back({ name, ToPanel(radiograph->GetOutput()) });
    side.levels.push_back({ name, ToPanel(RadiographOfLevel(mesh, side.geometry, *radiograph)) });
    cuts.push_back({ name, ToPanel(Voxelize(mesh, MakePlaneImage(cut))) });
    evaluation.levels.push_back(std::move(report));
  }

  const auto        percentiles = PercentileRange(evidence.ct, mask);
  const double      range = percentiles[1] - percentiles[0];
  const std::string unit = DensityUnitName(finest.quantity);
  const Window      window{ RoundInRange(percentiles[0] - 0.3 * range, range),
                       RoundInRange(percentiles[1] + 0.05 * range, range) };
  evaluation.mask = mask;
  evaluation.window = window;
  evaluation.slices = DrawSlices(evidence.ct, pipeline.GetContours(), window, unit, evidence.whole);
  Comparison comparison = CompareCut(cut, evidence.ct, std::move(cuts), window);
  comparison.scale = RoundInRange(0.25 * range, range);
  comparison.unit = unit;
  evaluation.cutPlane = DrawComparison({ comparison });
  const Vector3     centre = MeanOf(finest.points);
  const std::string integral = unit + "\u00B7mm";
  evaluation.radiographs =
    DrawComparison({ CompareRadiographs(front, centre, integral), CompareRadiographs(side, centre, integral) });
  return evaluation;
}
} // namespace bone
