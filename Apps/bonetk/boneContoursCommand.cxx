/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"

#include "boneContourIO.h"
#include "boneContourImage.h"
#include "boneContourResampleFilter.h"
#include "boneContourSliceFilter.h"
#include "boneMedialAxisFilter.h"
#include "boneResolution.h"
#include "boneSnakeContourFilter.h"

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
struct Options
{
  std::string ct;
  BoneOptions bone;
  double      sliceStep{ 0.0 };
  double      meanStep{ 0.0 };
  double      spacing{ 4.0 };
  double      leastSpacing{ 0.0 };
  double      tolerance{ 0.2 };
  double      layerDistance{ 0.0 };
  double      layerRatio{ 6.0 };
  double      samples{ 0.0 };
  double      tetrahedra{ 0.0 };
  int         axis{ 2 };
  int         layers{ 3 };
  bool        follow{ false };
  bool        refine{ false };
  bool        keepSmall{ false };

  std::vector<std::string> outputs;
};

bool
IsContourFile(const std::string & path)
{
  const auto ends = [&path](const std::string & extension) {
    return path.size() > extension.size() &&
           path.compare(path.size() - extension.size(), extension.size(), extension) == 0;
  };
  return ends(".vtp") || ends(".mrk.json");
}

/** The least distance between layers, which the pixel's size bounds below unless it was given. */
double
LayerDistance(const Options & options, const CTImage * ct)
{
  double pixel = 0.0;
  for (int a = 0; a < 3; ++a)
  {
    pixel = a == options.axis ? pixel : std::max(pixel, ct->GetSpacing()[static_cast<unsigned int>(a)]);
  }
  return options.layerDistance > 0.0 ? options.layerDistance : std::max(0.8, pixel);
}

/** Sets the spacings for a number of tetrahedra. */
void
FindSamples(double tetrahedra, ContourResampleFilter & resample, MedialAxisFilter & axes, Session & session)
{
  constexpr double off = 0.1;
  const auto       asked = static_cast<IdType>(std::llround(tetrahedra));
  const IdType     count = AdjustSamples(resample, axes, asked, [&session](IdType tried) {
    session.Print("tiled with " + std::to_string(tried) + " tetrahedra\n");
  });
  if (std::abs(static_cast<double>(count) / tetrahedra - 1.0) > off)
  {
    session.Warn("the nearest to " + std::to_string(asked) + " tetrahedra that was found is " + std::to_string(count) +
                 "; more or fewer slices (--adaptive-slices, --slice-step) would help");
  }
}

void
Run(const Options & options, Session & session)
{
  options.bone.Verify();
  for (const std::string & output : options.outputs)
  {
    if (!IsContourFile(output))
    {
      VerifyExtension(output, { ".vtp", ".mrk.json", ".nii", ".nii.gz", ".mha", ".mhd", ".nrrd" });
    }
  }
  if (options.leastSpacing > options.spacing)
  {
    throw UsageError("--least-spacing is above --contour-spacing");
  }
  const BoneInput        bone = ReadBone(options.bone, options.axis);
  const CTImage::Pointer ct = ReadCT(options.ct);
  const double           distance = LayerDistance(options, ct);
  auto                   snake = SnakeContourFilter<CTImage>::New();
  snake->SetInput(ct);
  snake->SetLabelImage(bone.labels);
  snake->SetInitialContours(bone.contours);
  snake->SetLabel(options.bone.label);
  snake->SetAxis(static_cast<unsigned int>(options.axis));
  snake->SetSliceStep(options.sliceStep);
  snake->SetNumberOfLayers(options.layers);
  snake->SetFollowLabel(options.follow);
  snake->SetMinimumLayerDistance(distance);
  snake->SetRefineLabelOutline(options.refine);
  snake->SetKeepSmallPieces(options.keepSmall);
  auto resample = ContourResampleFilter::New();
  auto slices = ContourSliceFilter::New();
  slices->SetInput(snake->GetOutput());
  slices->SetMeanSpacing(options.meanStep);
  resample->SetInput(slices->GetOutput());
  resample->SetMaximumSpacing(options.spacing);
  resample->SetMinimumSpacing(options.leastSpacing > 0.0 ? options.leastSpacing : options.spacing / 3.0);
  resample->SetTolerance(options.tolerance);
  resample->SetMinimumLayerDistance(distance);
  resample->SetThinLayerRatio(options.layerRatio);
  resample->SetTargetNumberOfSamples(static_cast<std::size_t>(std::llround(options.samples)));
  auto axes = MedialAxisFilter::New();
  axes->SetInput(resample->GetOutput());
  session.Watch(snake, "contours");
  session.Watch(slices, "choosing slices");
  session.Watch(resample, "resampling");
  session.Watch(axes, "medial axes");
  if (options.tetrahedra > 0.0)
  {
    FindSamples(options.tetrahedra, *resample, *axes, session);
  }
  axes->Update();
  for (const auto & warnings : { snake->GetWarnings(), resample->GetWarnings() })
  {
    std::for_each(warnings.begin(), warnings.end(), [&session](const std::string & line) { session.Warn(line); });
  }
  for (const std::string & output : options.outputs)
  {
    if (IsContourFile(output))
    {
      WriteContours(axes->GetOutput(), output);
    }
    else
    {
      WriteImage(RasterizeContours(axes->GetOutput(), ct), output);
    }
  }
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
  command
    ->add_option("--adaptive-slices",
                 options->meanStep,
                 "Keep slices this many mm apart on average, more of them where the sections change")
    ->check(Positive());
  command->add_option("--contour-spacing", options->spacing, "Largest distance of a contour's points in mm; default 4")
    ->check(Positive());
  AddAxisOption(command, options->axis);
  command
    ->add_option("--layers", options->layers, "1 periosteal, 2 with endosteal, 3 (default) with medullary contours")
    ->check(CLI::Range(1, 3).description(""));
  command
    ->add_option("--least-spacing",
                 options->leastSpacing,
                 "Least distance of a contour's points in mm; default: a third of the largest")
    ->check(Positive());
  command
    ->add_option("--tolerance", options->tolerance, "Distance of the fitted curves to the contours in mm; default 0.2")
    ->check(Positive());
  auto * samples = command->add_option(
    "--samples", options->samples, "Points of all contours, about; the spacings are scaled alike to give them");
  samples->check(Between(100, 1e8));
  command
    ->add_option("--tetrahedra",
                 options->tetrahedra,
                 "The same for the tetrahedra of their tiling, within 5 % where that can be; tiles them to count")
    ->check(Between(500, 1e8))
    ->excludes(samples);
  command
    ->add_option("--layer-distance",
                 options->layerDistance,
                 "Least distance between a contour and the next inside it in mm; default 0.8 or a pixel")
    ->check(Positive());
  command
    ->add_option("--layer-ratio",
                 options->layerRatio,
                 "Largest distance of points against the distance of the next contour; default 6")
    ->check(Positive());
  command
    ->add_flag(
      "--follow", options->follow, "The label map marks some slices only: follow the bone from them on the others")
    ->needs(command->get_option("--labels"));
  command->add_flag(
    "--refine", options->refine, "Move the label's outline to the edges of the CT, by half a pixel at most");
  command->add_flag(
    "--keep-small", options->keepSmall, "Keep pieces and holes of a single slice, and bodies of little volume");
  command
    ->add_option("-o,--output",
                 options->outputs,
                 "What to write: contours (.vtp, .mrk.json) or a label map (.nii.gz, .mha, ...); may be given again")
    ->required()
    ->allow_extra_args(false);
  command->callback([options, &action] { action = [options](Session & session) { Run(*options, session); }; });
}
} // namespace bone
