/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildEvaluation.h"

#include "boneBuildPage.h"
#include "boneBuildPlan.h"
#include "boneDensityEvaluation.h"
#include "boneDensityImageFilter.h"
#include "boneExecution.h"
#include "boneJpeg.h"
#include "boneMemory.h"
#include "boneTicks.h"
#include "boneVoxelDRRImageFilter.h"
#include "boneXRayPicture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

namespace bone
{
namespace evaluation
{
/** What levels are compared with, beside radiographs. */
struct References
{
  Evidence                            evidence; ///< with a mask
  std::optional<SurfaceDistanceMeter> distances;
  PlaneView                           cut;
  double                              range{ 0.0 }; ///< of 98 % of the CT in the mask
  Window                              window;       ///< of the CT in pictures
};

/** What is measured and drawn of a level by itself. */
struct LevelFindings
{
  LevelReport report;
  LevelPanel  cut;
};
} // namespace evaluation

namespace
{
using namespace evaluation;
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

References
MakeReferences(const Evidence & evidence, const MeshArrays & finest)
{
  References references;
  references.evidence = evidence;
  if (evidence.mask.IsNull())
  {
    references.evidence.mask = MaskOfMesh(finest, evidence.ct);
  }
  else
  {
    references.distances.emplace(evidence.mask);
  }
  references.cut = FrameLargestCut(finest.points, 5.0, 420);
  const auto [low, high] = PercentileRange(evidence.ct, references.evidence.mask);
  references.range = high - low;
  references.window = { RoundInRange(low - 0.3 * references.range, references.range),
                        RoundInRange(high + 0.05 * references.range, references.range) };
  return references;
}

/** \param level  from 0. */
LevelFindings
FindOut(const MeshType * mesh, std::size_t level, const References & references)
{
  const Evidence & evidence = references.evidence;
  const MeshArrays arrays = mesh->GetArrays();
  LevelReport      report = DescribeLevel(arrays);
  if (references.distances)
  {
    report.dice = DiceOverlap(arrays, evidence.mask);
    report.distances = references.distances->Measure(arrays);
  }
  report.density = CompareWithImage(arrays, evidence.ct, evidence.mask);
  const std::string name = LevelName(level, report);
  return { std::move(report), { name, ToPanel(Voxelize(mesh, MakePlaneImage(references.cut))) } };
}

SplineReport
DescribeSpline(const MeshType * spline, std::size_t coefficients, const Evidence & evidence)
{
  return { static_cast<std::size_t>(spline->GetNumberOfTetrahedra()),
           coefficients,
           CompareWithImage(spline->GetArrays(), evidence.ct, evidence.mask) };
}

/** In the pipeline's view and from the side; sets the levels' differences to the CT in the former. */
std::vector<Comparison>
CompareRadiographs(BuildPipeline &            pipeline,
                   const Evidence &           evidence,
                   const std::string &        unit,
                   std::vector<LevelReport> & reports)
{
  const auto &     levels = pipeline.GetHierarchy()->GetLevels();
  RadiographPanels front, side;
  front.geometry = pipeline.GetRadiograph(0)->GetGeometry();
  side.geometry = LateralView(levels.front().mesh);
  for (RadiographPanels * panels : { &front, &side })
  {
    panels->reference = RadiographOfCT(evidence.ct, evidence.mask, panels->geometry);
  }
  for (std::size_t i = 0; i < levels.size(); ++i)
  {
    BuildPipeline::RadiographType * radiograph = pipeline.GetRadiograph(i);
    radiograph->Update();
    reports[i].radiographPercent = RadiographDifferencePercent(front.reference, radiograph->GetOutput());
    const std::string name = LevelName(i, reports[i]);
    front.levels.push_back({ name, ToPanel(radiograph->GetOutput()) });
    side.levels.push_back({ name, ToPanel(RadiographOfLevel(levels[i].mesh, side.geometry, *radiograph)) });
  }
  const Vector3     centre = MeanOf(levels.front().mesh->GetArrays().points);
  const std::string integral = unit + "\u00B7mm";
  return { CompareRadiographs(front, centre, integral), CompareRadiographs(side, centre, integral) };
}
} // namespace

/** What is known before the coarser levels are. */
struct BuildEvaluator::Begun
{
  References                    references;
  LevelFindings                 finest;
  std::optional<BuildPageParts> page;
};

BuildEvaluator::BuildEvaluator(const Evidence & evidence, bool page, BuildPipeline & pipeline)
  : m_Pipeline(pipeline)
{
  ContourStack::Pointer contours = pipeline.GetContours();
  contours->Update();
  ReturnFreedMemory();
  m_Begun = RunBeside([evidence, page, contours, finest = pipeline.GetFinest()] {
    const MeshArrays arrays = finest->GetArrays();
    auto             begun = std::make_unique<Begun>();
    begun->references = MakeReferences(evidence, arrays);
    // First what takes one thread: loops share what the collapse leaves, and all processors after it.
    if (page)
    {
      begun->page = PackPageParts(evidence, *contours, arrays, begun->references.window);
    }
    begun->finest = FindOut(finest, 0, begun->references);
    if (page)
    {
      begun->page->lowerDegrees = LowerDegreeErrors(arrays, evidence.ct, begun->references.evidence.mask);
    }
    return begun;
  });
}

BuildEvaluator::~BuildEvaluator() = default;

Evaluation
BuildEvaluator::Finish()
{
  const auto              begun = m_Begun.get();
  References &            references = begun->references;
  const Evidence &        evidence = references.evidence;
  const auto &            levels = m_Pipeline.GetHierarchy()->GetLevels();
  Evaluation              evaluation;
  std::vector<LevelPanel> cuts;
  for (std::size_t i = 0; i < levels.size(); ++i)
  {
    LevelFindings found = i == 0 ? std::move(begun->finest) : FindOut(levels[i].mesh, i, references);
    found.report.densityErrorToLevel1 = levels[i].densityError;
    found.report.surfaceErrorToLevel1 = levels[i].surfaceError;
    found.report.stopReason = levels[i].stopReason;
    if (const auto spline = m_Pipeline.GetSpline(i))
    {
      found.report.spline = DescribeSpline(spline, m_Pipeline.GetSplineFit(i)->GetNumberOfFreeCoefficients(), evidence);
    }
    evaluation.levels.push_back(std::move(found.report));
    cuts.push_back(std::move(found.cut));
  }
  references.distances.reset();
  ReturnFreedMemory(); // radiographs of the CT take a copy of it for a time

  const std::string unit = DensityUnitName(levels.front().mesh->GetArrays().quantity);
  const double      range = references.range;
  evaluation.page = std::move(begun->page);
  Comparison cut = CompareCut(references.cut, evidence.ct, std::move(cuts), references.window);
  cut.scale = RoundInRange(0.25 * range, range);
  cut.unit = unit;
  const auto radiographs = CompareRadiographs(m_Pipeline, evidence, unit, evaluation.levels);
  const auto slices = [&] {
    return DrawSlices(evidence.ct, m_Pipeline.GetContours(), references.window, unit, evidence.whole);
  };
  const std::pair<EncodedPicture *, std::function<Canvas()>> pictures[] = {
    { &evaluation.slices, slices },
    { &evaluation.cutPlane, [&] { return DrawComparison({ cut }); } },
    { &evaluation.radiographs, [&] { return DrawComparison(radiographs); } }
  };
  Execution().For(std::size(pictures), [&pictures](std::size_t k) {
    const Canvas canvas = pictures[k].second(); // a canvas is one thread's
    *pictures[k].first = { canvas.GetPng(), ToJpeg(canvas.GetImage()) };
  });
  return evaluation;
}
} // namespace bone
