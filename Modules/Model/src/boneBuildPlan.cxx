/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneBuildPlan.h"

#include "boneLabelCrop.h"
#include "boneOwnOrientation.h"
#include "bonePlacement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bone
{
namespace
{
BuildInput
CropParts(const CTImage *             ct,
          const LabelImage *          labels,
          const ContourStack *        contours,
          const BuildPlanParameters & plan)
{
  BuildInput input;
  input.ct = const_cast<CTImage *>(ct);
  input.contours = const_cast<ContourStack *>(contours);
  if (labels == nullptr)
  {
    return input;
  }
  const LabelImage::Pointer onGrid = PutOnGrid(labels, ct);
  VerifyOneBone(onGrid, plan.label);
  const BoneExtent          extent = MeasureLabel(onGrid, plan.label);
  const CTImage::RegionType region = GrowRegion(ct, extent.region, plan.cropMargin);
  input.ct = Crop(ct, region);
  input.labels = Crop(onGrid, region);
  RemoveOtherLabels(plan.label, input.labels);
  input.surface = extent.surface;
  return input;
}

BuildInput
InOwnOrientation(BuildInput input)
{
  if (input.labels)
  {
    const std::array<bool, 3> flips = FindFlips(input.ct, input.labels);
    input.ct = Flip(input.ct, flips);
    input.labels = Flip(input.labels, flips);
  }
  return input;
}
} // namespace

BuildInput
CropToBone(const CTImage *             ct,
           const LabelImage *          labels,
           const ContourStack *        contours,
           const BuildPlanParameters & plan)
{
  return InOwnOrientation(CropParts(ct, labels, contours, plan));
}

BuildInput
CropToBone(const CTImage *             ct,
           const LabelledBone &        bone,
           const ContourStack *        contours,
           const BuildPlanParameters & plan)
{
  return InOwnOrientation(CropInOrder(ct, bone, contours, plan));
}

BuildInput
CropInOrder(const CTImage * ct, const LabelledBone & bone, const ContourStack * contours, BuildPlanParameters plan)
{
  plan.label = bone.label;
  if (bone.labels.IsNull() || bone.region.GetNumberOfPixels() == 0 || !IsSameGrid(ct, bone.labels))
  {
    return CropParts(ct, bone.labels.GetPointer(), contours, plan);
  }
  const CTImage::RegionType region = GrowRegion(ct, bone.region, plan.cropMargin);
  const CTImage::Pointer    part = Crop(ct, region);
  const LabelImage::Pointer labels = Crop(bone.labels.GetPointer(), region);
  return CropParts(part, labels, contours, plan);
}

double
FindDistanceBound(const itk::ImageBase<3> & ct, const BuildPlanParameters & plan)
{
  double bound = plan.largestDistanceBound;
  for (unsigned int d = 0; d < 3; ++d)
  {
    bound = d == plan.axis ? bound : std::min(bound, 0.5 * ct.GetSpacing()[d]);
  }
  return bound;
}

void
DrawOutlineToEdges(const itk::ImageBase<3> & ct, SnakeContourParameters & contours)
{
  constexpr double least = 1.5, voxels = 2.0;
  const auto &     spacing = ct.GetSpacing();
  contours.refineLabelOutline = true;
  contours.refineDistance = std::max(least, voxels * *std::max_element(spacing.begin(), spacing.end()));
}

std::vector<IdType>
CountTetrahedraOfLevels(const std::vector<double> & levels, IdType finest)
{
  std::vector<IdType> counts;
  for (const double level : levels)
  {
    counts.push_back(static_cast<IdType>(std::lround(level < 1.0 ? level * static_cast<double>(finest) : level)));
    if (counts.back() >= (counts.size() == 1 ? finest : counts[counts.size() - 2]))
    {
      throw std::invalid_argument("levels must descend and be below the first level's " + std::to_string(finest) +
                                  " tetrahedra");
    }
  }
  return counts;
}

void
SetBuild(const BuildInput & input, const BuildParameters & parameters, BuildPipeline & pipeline)
{
  BuildParameters stages = parameters;
  stages.contours.label = stages.quality.label = parameters.plan.label;
  stages.contours.axis = parameters.plan.axis;
  stages.quality.distanceBound = FindDistanceBound(*input.ct, parameters.plan);
  pipeline.SetParameters(stages);
  const Placement placement = PlacementOf(*input.ct);
  pipeline.SetPlacement(placement);
  pipeline.SetImage(OnOwnGrid(input.ct));
  pipeline.SetLabelImage(OnOwnGrid(input.labels));
  pipeline.SetInitialContours(input.contours ? Place(*input.contours, placement.Inverse()) : nullptr);
}

Resolution
PlanBuild(const BuildInput &                                      input,
          const BuildParameters &                                 parameters,
          BuildPipeline &                                         pipeline,
          const std::function<void(const Resolution &, IdType)> & tried)
{
  const BuildPlanParameters & plan = parameters.plan;
  SetBuild(input, parameters, pipeline);
  double surface = input.surface;
  if (!(surface > 0.0))
  {
    // How large the bone is shows once its contours were followed.
    pipeline.GetSnake()->SetSliceStep(plan.probeStep);
    pipeline.GetSnake()->Update();
    surface = EstimateSurface(*pipeline.GetSnake()->GetOutput());
  }
  const double sliceSpacing = input.ct->GetSpacing()[plan.axis];
  Resolution   resolution = EstimateResolution(surface, sliceSpacing, plan.tetrahedra);
  if (plan.sliceStep > 0.0)
  {
    resolution.contourSpacing *= resolution.sliceStep / plan.sliceStep;
    resolution.sliceStep = plan.sliceStep;
  }
  const ResolutionSearch search{ plan.tetrahedra, sliceSpacing, plan.sliceStep > 0.0, !plan.regularSlices };
  if (!(plan.contourSpacing > 0.0))
  {
    return AdjustResolution(pipeline, resolution, search, tried);
  }
  resolution.contourSpacing = plan.contourSpacing;
  SetResolution(pipeline, resolution, search);
  pipeline.GetQuality()->Update();
  return resolution;
}

namespace
{
XRayGeometry::Pointer
FramedView(const BuildPipeline::MeshType * mesh, const Vector3 & beam)
{
  Vector3 lower = Vector3::Constant(std::numeric_limits<double>::max());
  Vector3 upper = -lower;
  for (const Vector3 & p : mesh->GetArrays().points)
  {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  auto geometry = XRayGeometry::New();
  geometry->SetView(
    XRayGeometry::Framing(lower - Vector3::Constant(5.0), upper + Vector3::Constant(5.0), beam, Vector3::UnitZ(), 400));
  return geometry;
}
} // namespace

XRayGeometry::Pointer
FrontView(const BuildPipeline::MeshType * mesh)
{
  return FramedView(mesh, Vector3::UnitY());
}

XRayGeometry::Pointer
LateralView(const BuildPipeline::MeshType * mesh)
{
  return FramedView(mesh, -Vector3::UnitX());
}

void
FinishBuild(const BuildPlanParameters & plan, const XRayGeometry * geometry, BuildPipeline & pipeline)
{
  pipeline.GetQuality()->Update();
  pipeline.GetCollapse()->SetLevels(
    CountTetrahedraOfLevels(plan.levels, pipeline.GetQuality()->GetOutput()->GetNumberOfTetrahedra()));
  pipeline.GetHierarchy()->Update();
  pipeline.SetGeometry(geometry != nullptr ? geometry : FrontView(pipeline.GetHierarchy()->GetMesh(0)).GetPointer());
  pipeline.Update();
}
} // namespace bone
