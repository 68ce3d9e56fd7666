/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"

#include "boneContourIO.h"
#include "boneContourResampleFilter.h"
#include "boneMedialAxisFilter.h"
#include "boneSnakeContourFilter.h"

#include <algorithm>

namespace bone
{
namespace
{
struct Options
{
  std::string ct;
  BoneOptions bone;
  double      sliceStep{ 0.0 };
  double      spacing{ 4.0 };
  int         axis{ 2 };
  int         layers{ 3 };
  std::string output;
};

void
Run(const Options & options, Session & session)
{
  options.bone.Verify();
  VerifyExtension(options.output, { ".vtp" });
  const BoneInput bone = ReadBone(options.bone);
  auto            snake = SnakeContourFilter<CTImage, ContourStack>::New();
  snake->SetInput(ReadCT(options.ct));
  snake->SetLabelImage(bone.labels);
  snake->SetInitialContours(bone.contours);
  snake->SetLabel(options.bone.label);
  snake->SetAxis(static_cast<unsigned int>(options.axis));
  snake->SetSliceStep(options.sliceStep);
  snake->SetNumberOfLayers(options.layers);
  auto resample = ContourResampleFilter<ContourStack>::New();
  resample->SetInput(snake->GetOutput());
  resample->SetMaximumSpacing(options.spacing);
  resample->SetMinimumSpacing(options.spacing / 3.0);
  auto axes = MedialAxisFilter<ContourStack>::New();
  axes->SetInput(resample->GetOutput());
  session.Watch(snake, "contours");
  session.Watch(resample, "resampling");
  session.Watch(axes, "medial axes");
  axes->Update();
  for (const auto & warnings : { snake->GetWarnings(), resample->GetWarnings() })
  {
    std::for_each(warnings.begin(), warnings.end(), [&session](const std::string & line) { session.Warn(line); });
  }
  WriteContours(axes->GetOutput(), options.output);
}
} // namespace

void
AddContoursCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<Options>();
  auto * command = app.add_subcommand("contours", "Contours of a bone on every slice, by layer, with medial axes");
  command->add_option("ct", options->ct, "CT: an image file, or the folder of a DICOM series")->required();
  options->bone.AddTo(command);
  command->add_option("--slice-step", options->sliceStep, "Distance of slices in mm; default: every slice of the CT")
    ->check(Positive());
  command->add_option("--contour-spacing", options->spacing, "Largest distance of a contour's points in mm; default 4")
    ->check(Positive());
  AddAxisOption(command, options->axis);
  command
    ->add_option("--layers", options->layers, "1 periosteal, 2 with endosteal, 3 (default) with medullary contours")
    ->check(CLI::Range(1, 3).description(""));
  command->add_option("-o,--output", options->output, "Contours to write (.vtp)")->required();
  command->callback([options, &action] { action = [options](Session & session) { Run(*options, session); }; });
}
} // namespace bone
