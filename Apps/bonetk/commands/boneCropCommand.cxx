/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
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
  std::string         labels;
  BuildPlanParameters plan;
  std::string         output;
  std::string         labelsOutput;
};

void
RunCrop(const CropOptions & options, Session &)
{
  VerifyOutputs({ { options.output, ImageExtensions() }, { options.labelsOutput, ImageExtensions() } });
  const CTImage::Pointer    ct = ReadCT(options.ct);
  const LabelImage::Pointer labels = ReadBoneLabels(options.labels, options.plan.label);
  const BuildInput          input = CropToBone(ct, labels, nullptr, options.plan);
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
  command->add_option("--labels", options->labels, "Label map on the CT's grid")->required();
  AddParameterOptions(command, options->plan, { "label", "cropMargin" });
  command->add_option("-o,--output", options->output, "CT to write; .mha and .nrrd keep its place exactly")->required();
  command->add_option("--write-labels", options->labelsOutput, "Label map to write");
  command->callback([options, &action] { action = [options](Session & session) { RunCrop(*options, session); }; });
}
} // namespace bone
