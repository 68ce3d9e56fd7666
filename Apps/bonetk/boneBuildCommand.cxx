/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"
#include "boneStagingFolder.h"

#include "boneAtomicFile.h"
#include "boneBernstein.h"
#include "boneLabelCrop.h"
#include "boneBuildEvaluation.h"
#include "boneContourIO.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneStageClock.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

namespace bone
{
namespace
{
struct Options
{
  std::string         ct;
  BoneOptions         bone;
  std::string         output;
  int                 degree{ 3 };
  bool                continuous{ false };
  IdType              tetrahedra{ 33000 };
  std::vector<double> levels{ 0.2, 1.0 / 13.0 };
  double              sliceStep{ 0.0 };
  double              contourSpacing{ 0.0 };
  bool                regularSlices{ false };
  int                 axis{ 2 };
};

/** The CT and the labels, cut down to the bone. */
struct Input
{
  CTImage::Pointer      ct;
  LabelImage::Pointer   labels; ///< null without a label map
  LabelImage::Pointer   mask;   ///< null without a label map
  ContourStack::Pointer contours;
  double                surface{ 0.0 }; ///< of the label, mm^2; 0 without a label map
};

Input
ReadInput(const Options & options)
{
  constexpr double margin = 10.0;
  Input            input;
  input.ct = ReadCT(options.ct);
  BoneInput bone = ReadBone(options.bone, options.axis);
  input.contours = bone.contours;
  if (bone.labels.IsNull())
  {
    return input;
  }
  VerifySameGrid(input.ct, bone.labels);
  const BoneExtent          extent = MeasureLabel(bone.labels, options.bone.label);
  const CTImage::RegionType region = GrowRegion(input.ct, extent.region, margin);
  input.ct = Crop(input.ct, region);
  input.labels = Crop(bone.labels, region);
  input.mask = MaskOfLabel(input.labels, options.bone.label);
  input.surface = extent.surface;
  return input;
}

/** Numbers of tetrahedra of the coarser levels; what is below 1 is a share of the first. */
std::vector<IdType>
CountsOfLevels(const std::vector<double> & levels, IdType finest)
{
  std::vector<IdType> counts;
  for (const double level : levels)
  {
    counts.push_back(static_cast<IdType>(std::lround(level < 1.0 ? level * finest : level)));
    if (counts.back() >= (counts.size() == 1 ? finest : counts[counts.size() - 2]))
    {
      throw UsageError("--levels must descend and be below the first level's " + std::to_string(finest) +
                       " tetrahedra");
    }
  }
  return counts;
}

/** How far the quality stage may move surfaces, mm: half a pixel of the slices, but no more than keeps the overlap with
 * a label map of large voxels. */
double
DistanceBound(const CTImage & ct, int axis)
{
  constexpr double largest = 0.3;
  double           bound = largest;
  for (int d = 0; d < 3; ++d)
  {
    bound = d == axis ? bound : std::min(bound, 0.5 * ct.GetSpacing()[static_cast<unsigned int>(d)]);
  }
  return bound;
}

/** Sets the pipeline up and finds the resolution; the tiling is then up to date. */
Resolution
FindResolution(const Options & options, const Input & input, BuildPipeline & pipeline, Session & session)
{
  pipeline.SetImage(input.ct);
  pipeline.SetLabelImage(input.labels);
  pipeline.SetInitialContours(input.contours);
  pipeline.GetSnake()->SetLabel(options.bone.label);
  pipeline.GetQuality()->SetLabel(options.bone.label);
  pipeline.GetSnake()->SetAxis(static_cast<unsigned int>(options.axis));
  double surface = input.surface;
  if (input.labels.IsNull())
  {
    // How large the bone is shows once its contours were followed.
    pipeline.GetSnake()->SetSliceStep(5.0);
    pipeline.GetSnake()->Update();
    surface = EstimateSurface(*pipeline.GetSnake()->GetOutput());
  }
  const double sliceSpacing = input.ct->GetSpacing()[static_cast<unsigned int>(options.axis)];
  Resolution   resolution = EstimateResolution(surface, sliceSpacing, options.tetrahedra);
  if (options.sliceStep > 0.0)
  {
    resolution.contourSpacing *= resolution.sliceStep / options.sliceStep;
    resolution.sliceStep = options.sliceStep;
  }
  pipeline.GetQuality()->SetDistanceBound(DistanceBound(*input.ct, options.axis));
  pipeline.GetFit()->SetDegree(options.degree);
  pipeline.GetFit()->SetContinuous(options.continuous);
  const ResolutionSearch search{ options.tetrahedra, sliceSpacing, options.sliceStep > 0.0, !options.regularSlices };
  if (options.contourSpacing > 0.0)
  {
    resolution.contourSpacing = options.contourSpacing;
    SetResolution(pipeline, resolution, search);
    pipeline.GetTiling()->Update();
  }
  else
  {
    resolution = AdjustResolution(pipeline, resolution, search, [&](const Resolution & tried, IdType count) {
      std::ostringstream line;
      line << "slices " << tried.sliceStep << " mm, contour points at most " << tried.contourSpacing
           << " mm apart: " << count << " tetrahedra\n";
      session.Print(line.str());
    });
  }
  for (const std::string & warning : pipeline.GetWarnings())
  {
    session.Warn(warning);
  }
  return resolution;
}

void
WriteOutputs(const Evaluation &  evaluation,
             const BuildReport & report,
             BuildPipeline &     pipeline,
             StagingFolder &     staging)
{
  const auto in = [&staging](const std::string & name) { return staging.GetPath() + "/" + name; };
  WriteContours(pipeline.GetMedialAxis()->GetOutput(), in("contours.vtp"));
  WriteHierarchy(pipeline.GetCollapse()->GetOutput(), in("model"));
  auto geometry = const_cast<XRayGeometry *>(pipeline.GetRadiograph(0)->GetGeometry());
  WriteGeometry({ geometry }, in("drr_geometry.json"));
  for (std::size_t level = 0; level < pipeline.GetNumberOfLevels(); ++level)
  {
    WriteImage(pipeline.GetRadiograph(level)->GetOutput(), in("drr_L" + std::to_string(level + 1) + ".mha"));
  }
  WriteImage(evaluation.slices, in("slices.png"));
  WriteImage(evaluation.cutPlane, in("cut_plane.png"));
  WriteImage(evaluation.radiographs, in("radiographs.png"));
  WriteFileAtomically(in("report.txt"), ToText(report));
  WriteFileAtomically(in("report.json"), ToJson(report));
  staging.Commit();
}

void
Run(const Options & options, Session & session)
{
  options.bone.Verify();
  StagingFolder staging(options.output);
  auto          before = std::chrono::steady_clock::now();
  const auto    lap = [&before] {
    const auto   now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - before).count();
    before = now;
    return seconds;
  };
  BuildReport report;
  const Input input = ReadInput(options);
  report.times.emplace_back("reading", lap());

  BuildPipeline pipeline(options.levels.size() + 1);
  StageClock    clock(pipeline.GetStages());
  for (const auto & [name, filter] : pipeline.GetStages())
  {
    session.Watch(filter, name);
  }
  report.resolution = FindResolution(options, input, pipeline, session);
  const auto geometry = FrontView(pipeline.GetTiling()->GetOutput());
  pipeline.SetGeometry(geometry);
  pipeline.GetQuality()->Update();
  pipeline.GetCollapse()->SetLevels(
    CountsOfLevels(options.levels, pipeline.GetQuality()->GetOutput()->GetNumberOfTetrahedra()));
  pipeline.Update();
  lap();
  for (const auto & entry : clock.GetSeconds())
  {
    report.times.push_back(entry);
  }

  const Evaluation evaluation = Evaluate(pipeline, { input.ct, input.mask });
  report.times.emplace_back("evaluation", lap());
  report.version = BONETK_VERSION;
  report.image = options.ct;
  report.labels = options.bone.labels;
  report.label = options.bone.label;
  report.initialContours = options.bone.init;
  report.degree = options.degree;
  report.continuous = options.continuous;
  report.askedTetrahedra = options.tetrahedra;
  report.slices = pipeline.GetSlices()->GetOutput()->GetSlices().size();
  report.tiling = pipeline.GetTiling()->GetReport();
  report.levels = evaluation.levels;
  report.warnings = session.GetWarnings();
  WriteOutputs(evaluation, report, pipeline, staging);
  session.Print("\n" + ToText(report) + "\nwritten to " + options.output + "\n");
}
} // namespace

void
AddBuildCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<Options>();
  auto * command =
    app.add_subcommand("build", "The whole job: from a CT to a hierarchy of density models, with a report");
  command->add_option("ct", options->ct, "CT: an image file, or the folder of a DICOM series")->required();
  options->bone.AddTo(command);
  command->add_option("-o,--output", options->output, "Folder for models, contours, pictures and report")->required();
  command->add_option("--degree", options->degree, "Degree of the density polynomials, 0 to 8; default 3")
    ->check(CLI::Range(0, MaximumBernsteinDegree).description(""));
  command->add_flag("--continuous", options->continuous, "One continuous density within each region");
  command->add_option("--tetrahedra", options->tetrahedra, "Tetrahedra of the first level, about; default 33000")
    ->check(Between(500, 1e7));
  command
    ->add_option("--levels",
                 options->levels,
                 "Coarser levels: numbers of tetrahedra, or shares of the first level; default 0.2 0.0769")
    ->check(Positive());
  command
    ->add_option("--slice-step", options->sliceStep, "Mean distance of slices in mm; default: chosen for --tetrahedra")
    ->check(Positive());
  command->add_flag(
    "--regular-slices", options->regularSlices, "Slices evenly spaced, and not more of them where the sections change");
  command
    ->add_option("--contour-spacing",
                 options->contourSpacing,
                 "Largest distance of a contour's points in mm; default: chosen for --tetrahedra")
    ->check(Positive());
  AddAxisOption(command, options->axis);
  command->callback([options, &action] { action = [options](Session & session) { Run(*options, session); }; });
}
} // namespace bone
