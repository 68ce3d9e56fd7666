/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildEvaluation.h"

#include "boneDensityImageFilter.h"
#include "boneVoxelDRRImageFilter.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

LabelImage::Pointer
MaskOfModel(const CTImage * model)
{
  auto mask = LabelImage::New();
  mask->CopyInformation(model);
  mask->SetRegions(model->GetLargestPossibleRegion());
  mask->Allocate();
  const float * density = model->GetBufferPointer();
  short *       inside = mask->GetBufferPointer();
  for (std::size_t k = 0; k < model->GetLargestPossibleRegion().GetNumberOfPixels(); ++k)
  {
    inside[k] = std::isnan(density[k]) ? 0 : 1;
  }
  return mask;
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
  return "L" + std::to_string(level + 1) + ", " + std::to_string(report.tetrahedra) + " tetra";
}

double
LargestValue(const Panel & panel)
{
  return *std::max_element(panel.values.begin(), panel.values.end());
}
} // namespace

Evaluation
Evaluate(BuildPipeline & pipeline, const Evidence & evidence)
{
  const auto & levels = pipeline.GetCollapse()->GetOutput()->GetLevels();
  const auto   finest = levels.front().mesh->GetArrays();
  Evaluation   evaluation;

  LabelImage::ConstPointer mask = evidence.mask;
  PlaneView                cut = FrameLargestCut(finest.points, 5.0, 420);
  std::vector<LevelPanel>  cuts;
  std::vector<LevelPanel>  radiographs;
  CTImage::Pointer         reference;
  for (std::size_t i = 0; i < levels.size(); ++i)
  {
    const MeshType *       mesh = levels[i].mesh;
    const MeshArrays       arrays = mesh->GetArrays();
    const CTImage::Pointer model = Voxelize(mesh, evidence.ct);
    if (mask.IsNull())
    {
      mask = MaskOfModel(model);
    }
    LevelReport report = DescribeLevel(arrays);
    report.densityErrorToLevel1 = levels[i].densityError;
    report.surfaceErrorToLevel1 = levels[i].surfaceError;
    report.stopReason = levels[i].stopReason;
    if (evidence.mask.IsNotNull())
    {
      report.dice = DiceOverlap(model, mask);
      report.distances = MeasureSurfaceDistances(arrays, mask);
    }
    report.density = CompareWithImage(arrays, evidence.ct, mask);

    BuildPipeline::RadiographType * radiograph = pipeline.GetRadiograph(i);
    radiograph->Update();
    if (reference.IsNull())
    {
      reference = RadiographOfCT(evidence.ct, mask, radiograph->GetGeometry());
    }
    report.radiographPercent = RadiographDifferencePercent(reference, radiograph->GetOutput());
    const std::string name = LevelName(i, report);
    radiographs.push_back({ name, ToPanel(radiograph->GetOutput()) });
    cuts.push_back({ name, ToPanel(Voxelize(mesh, MakePlaneImage(cut))) });
    evaluation.levels.push_back(std::move(report));
  }

  const auto   percentiles = PercentileRange(evidence.ct, mask);
  const double range = percentiles[1] - percentiles[0];
  const Window window{ percentiles[0] - 0.3 * range, percentiles[1] + 0.05 * range };
  evaluation.slices = DrawSlices(evidence.ct, pipeline.GetMedialAxis()->GetOutput(), window);
  const double cutScale = 0.25 * range;
  evaluation.cutPlane = DrawComparison(SamplePlane(evidence.ct, cut), "CT", cuts, window, cutScale);
  const Panel  panel = ToPanel(reference);
  const double largest = LargestValue(panel);
  evaluation.radiographs = DrawComparison(panel, "CT", radiographs, { 0.0, 0.9 * largest }, 0.1 * largest);
  return evaluation;
}
} // namespace bone
