/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneBuildPlan.h"
#include "boneContourIO.h"
#include "boneFileName.h"
#include "boneContourImage.h"
#include "bonePlacement.h"

#include <algorithm>
#include <sstream>

namespace bone
{
namespace
{
struct ContoursOptions
{
  std::string              ct;
  std::string              series;
  BoneOptions              bone;
  BuildParameters          parameters;
  bool                     tetrahedra{ false };   ///< asked for
  bool                     leastSpacing{ false }; ///< given
  bool                     tolerance{ false };    ///< given
  std::vector<std::string> outputs;
  std::string              allSlices;
};

bool
IsContourFile(const std::string & path)
{
  return HasExtension(path, ".vtp") || HasExtension(path, ".mrk.json");
}

void
Verify(const ContoursOptions & options)
{
  options.bone.Verify();
  std::vector<std::string> kinds = ImageExtensions();
  kinds.insert(kinds.begin(), { ".vtp", ".mrk.json" });
  std::vector<OutputFile> files{ { options.allSlices, { ".vtp" } } };
  for (const std::string & output : options.outputs)
  {
    files.push_back({ output, kinds });
  }
  VerifyOutputs(files);
}

/** Sets the spacings of a build for slices and contours that are given, or of every slice and the default spacing. */
void
SetGivenResolution(const ContoursOptions & options,
                   const BuildParameters & parameters,
                   const BuildInput &      input,
                   BuildPipeline &         pipeline)
{
  const BuildPlanParameters & plan = parameters.plan;
  SetBuild(input, parameters, pipeline);
  const double spacing = plan.contourSpacing > 0.0 ? plan.contourSpacing : ContourResampleParameters().maximumSpacing;
  if (plan.sliceStep > 0.0)
  {
    SetResolution(pipeline,
                  { plan.sliceStep, spacing },
                  { plan.tetrahedra, input.ct->GetSpacing()[plan.axis], true, !plan.regularSlices });
  }
  else
  {
    pipeline.SetContourSpacing(spacing);
  }
  const ContourResampleParameters & resample = parameters.resample;
  if (options.leastSpacing)
  {
    pipeline.GetResample()->SetMinimumSpacing(resample.minimumSpacing);
  }
  if (options.tolerance)
  {
    pipeline.GetResample()->SetTolerance(resample.tolerance);
  }
}

void
RunContours(const ContoursOptions & options, Session & session)
{
  Verify(options);
  BuildParameters        parameters = options.parameters;
  const CTImage::Pointer ct = ReadChosenCT(options.ct, options.series, session);
  const BoneInput        read = ReadOneBone(options.bone, parameters.plan.axis, ct, session);
  parameters.plan.label = read.bone.label;
  const int trials = options.tetrahedra ? 4 : 0;
  session.Expect({ { "contours", 2.0 },
                   { "slices", 0.3, std::max(1, trials) },
                   { "resample", 0.1, std::max(1, trials) },
                   { "medial axis", 0.05, std::max(1, trials) },
                   { "tiling", 1.2, trials },
                   { "quality", options.tetrahedra ? 5.0 : 0.0 } });
  BuildPipeline pipeline(1);
  for (const auto & [name, filter] : pipeline.GetStages())
  {
    session.Watch(filter, name);
  }
  // From a few slices the bone is followed through all of the CT.
  const BuildInput input = parameters.contours.followLabel ? BuildInput{ ct, read.bone.labels, read.contours, 0.0 }
                                                           : CropToBone(ct, read.bone, read.contours, parameters.plan);
  if (options.tetrahedra)
  {
    PlanBuild(input, parameters, pipeline, [&session](const Resolution &, IdType tried) {
      session.Print("tiled for about " + std::to_string(tried) + " tetrahedra\n");
    });
  }
  else
  {
    SetGivenResolution(options, parameters, input, pipeline);
  }
  pipeline.GetContours()->Update();
  const ContourStack * contours = pipeline.GetContours();
  for (const std::string & doubt : pipeline.GetSnake()->GetReport().doubts)
  {
    session.WarnAlways(doubt);
  }
  for (const auto & warnings : { pipeline.GetSnake()->GetWarnings(), pipeline.GetResample()->GetWarnings() })
  {
    std::for_each(warnings.begin(), warnings.end(), [&session](const std::string & line) { session.Warn(line); });
  }
  std::ostringstream text;
  text << contours->GetSlices().size() << " slices, on average " << contours->GetMeanSliceDistance() << " mm apart\n";
  session.Print(text.str());
  for (const std::string & output : options.outputs)
  {
    if (IsContourFile(output))
    {
      WriteContours(contours, output);
    }
    else
    {
      WriteImage(RasterizeContours(contours, ct), output);
    }
  }
  if (!options.allSlices.empty())
  {
    WriteContours(Place(*pipeline.GetSnake()->GetOutput(), PlacementOf(*input.ct)), options.allSlices);
  }
}
} // namespace

void
AddContoursCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<ContoursOptions>();
  auto * command = app.add_subcommand("contours", "Contours of a bone on every slice, by layer, with medial axes");
  command->add_option("ct", options->ct, "CT: an image file, or the folder of a DICOM series")->required();
  AddSeriesOption(command, options->series);
  options->bone.AddTo(command);
  BuildParameters & parameters = options->parameters;
  AddParameterOptions(command, parameters.plan, { "tetrahedra", "sliceStep", "regularSlices", "contourSpacing" });
  AddAxisOption(command, parameters.plan.axis);
  AddParameterOptions(command,
                      parameters.contours,
                      { "refineLabelOutline",
                        "refineDistance",
                        "followLabel",
                        "minimumEdgeSlope",
                        "numberOfLayers",
                        "minimumLayerDistance",
                        "minimumContourArea",
                        "keepSmallPieces",
                        "boneThreshold",
                        "endostealThreshold",
                        "medullaryThreshold",
                        "maximumCorticalThickness" });
  AddParameterOptions(
    command, parameters.resample, { "minimumSpacing", "tolerance", "thinLayerRatio", "targetNumberOfSamples" });
  AddParameterOptions(command, parameters.slices);
  AddParameterOptions(command, parameters.medialAxis);
  // What says how many points there are, in one way.
  command->get_option("--tetrahedra")->excludes("--samples")->excludes("--contour-spacing");
  command->get_option("--tetrahedra")->excludes("--least-spacing")->excludes("--tolerance");
  command->get_option("--follow")->needs("--labels");
  command->get_option("--tetrahedra")
    ->description(
      std::string(
        "Slices and spacings such that tiling and quality stage give about so many tetrahedra, as `build` finds them; "
        "default: every slice, or --slice-step, and --contour-spacing, ") +
      ParameterText(ContourResampleParameters().maximumSpacing) + " mm");
  command->add_option("--write-all-slices",
                      options->allSlices,
                      "Where to write the contours of every slice too (.vtp), before slices are chosen and contours "
                      "resampled: what `smooth --contours` fits surfaces to");
  command
    ->add_option("-o,--output",
                 options->outputs,
                 "What to write: contours (.vtp, .mrk.json) or a label map (.nii.gz, .mha, ...); may be given again")
    ->required()
    ->allow_extra_args(false);
  command->callback([options, command, &action] {
    options->tetrahedra = command->count("--tetrahedra") > 0;
    options->leastSpacing = command->count("--least-spacing") > 0;
    options->tolerance = command->count("--tolerance") > 0;
    if (command->count("--layer-distance") > 0)
    {
      options->parameters.resample.minimumLayerDistance = options->parameters.contours.minimumLayerDistance;
    }
    action = [options](Session & session) { RunContours(*options, session); };
  });
}
} // namespace bone
