/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneBuildPlan.h"

namespace bone
{
namespace
{
struct CropOptions
{
  std::string         ct;
  std::string         series;
  LabelOptions        labels;
  BuildPlanParameters plan;
  std::string         output;
  std::string         labelsOutput;
};

void
RunCrop(const CropOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, ImageExtensions() }, { options.labelsOutput, ImageExtensions() } });
  const VolumeSource::Pointer ct = OpenChosenCT(options.ct, options.series, session);
  const LabelledBone          bone = ReadOneBoneLabels(options.labels, ct->GetOutput(), session, true);
  const BuildInput            input = CropInOrder(ct->GetOutput(), bone, nullptr, options.plan);
  WriteImage(input.ct, options.output);
  if (!options.labelsOutput.empty())
  {
    WriteImage(input.labels, options.labelsOutput);
  }
}
} // namespace

void
AddCropCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<CropOptions>();
  auto * command = app.add_subcommand("crop", "Cut a CT and its label map down to one bone, as build does");
  command->add_option("ct", options->ct, "CT: an image file, or the folder of a DICOM series")->required();
  AddSeriesOption(command, options->series);
  options->labels.AddTo(command, "Label map, or closed surface, of the bone")->required();
  AddParameterOptions(command, options->plan, { "cropMargin" });
  command->add_option("-o,--output", options->output, "CT to write; .mha and .nrrd keep its place exactly")->required();
  command->add_option("--write-labels", options->labelsOutput, "Label map to write");
  command->callback([options, &action] { action = [options](Session & session) { RunCrop(*options, session); }; });
}
} // namespace bone
