/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneMakePhantom.h"
#include "boneMeshIO.h"
#include "bonePhantomImageSource.h"
#include "boneSurfacePhantom.h"

namespace bone
{
namespace
{
struct PhantomOptions
{
  std::string            bone{ "femur" };
  std::string            surface;
  std::uint64_t          subject{ 0 };
  double                 spacing{ 1.0 };
  double                 sliceSpacing{ 0.0 };
  PhantomImageParameters image;
  std::string            output;
  std::string            labels;
};

PhantomModel::Pointer
MakeModel(const PhantomOptions & options)
{
  if (options.surface.empty())
  {
    return MakePhantom(options.bone, options.subject);
  }
  const TriangleSurface                   surface = ReadTriangleSurface(options.surface);
  std::vector<TriangleDistance::Triangle> triangles(surface.triangles.begin(), surface.triangles.end());
  return std::make_shared<const SurfacePhantom>(
    surface.points, triangles, SurfacePhantomParameters::ForSubject(options.subject));
}

void
RunPhantom(const PhantomOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, ImageExtensions() }, { options.labels, ImageExtensions() } });
  using SourceType = PhantomImageSource<CTImage>;
  auto source = SourceType::New();
  source->SetModel(MakeModel(options));
  SourceType::SpacingType spacing;
  spacing.Fill(options.spacing);
  spacing[2] = options.sliceSpacing > 0.0 ? options.sliceSpacing : options.spacing;
  source->SetSpacing(spacing);
  source->SetParameters(options.image);
  source->SetNoiseSeed(options.subject + 1);
  session.Watch(source, "phantom");
  source->Update();
  WriteImage(source->GetOutput(), options.output);
  if (!options.labels.empty())
  {
    WriteImage(source->GetLabelOutput(), options.labels);
  }
}
} // namespace

void
AddPhantomCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<PhantomOptions>();
  auto * command = app.add_subcommand("phantom", "Make the CT of an analytic bone with a known density and label map");
  auto * bone = command->add_option("--bone", options->bone, "Which bone; default femur")
                  ->check(CLI::IsMember(PhantomNames()).description(""))
                  ->type_name("femur|hemipelvis");
  command->add_option("--surface", options->surface, "In place of --bone: a closed surface (.ply, .vtp, .stl)")
    ->excludes(bone);
  command->add_option("--subject", options->subject, "Seed of the subject; default 0, the mean subject");
  command->add_option("--spacing", options->spacing, "Voxel size in mm; default 1")->check(Length());
  command->add_option("--slice-spacing", options->sliceSpacing, "Distance of slices in mm; default: --spacing")
    ->check(Length());
  AddParameterOptions(command, options->image);
  command->add_option("-o,--output", options->output, "CT to write (.nii.gz, .mha, .nrrd, ...)")->required();
  command->add_option("--labels", options->labels, "Label map to write: 1 cortical, 2 trabecular, 3 medullary cavity");
  command->callback([options, &action] { action = [options](Session & session) { RunPhantom(*options, session); }; });
}
} // namespace bone
