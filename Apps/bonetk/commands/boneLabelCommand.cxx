/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasInputs.h"
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneFileName.h"

#include <filesystem>
#include <stdexcept>

namespace bone
{
namespace
{
struct LabelCommandOptions
{
  std::string              ct;
  std::string              series;
  std::vector<std::string> atlases;
  std::vector<std::string> mirrored; ///< atlases whose mirror image is sought
  AtlasVolumeParameters    parameters;
  std::string              output;
};

/** A bone to find. */
struct LabelJob
{
  std::string atlas;
  MirrorMode  mirror;
};

/** Puts `value` where the bone is and nothing was found before; returns how many voxels another bone has already. */
std::size_t
Paint(const LabelImage & bone, short value, LabelImage & labels)
{
  const std::size_t count = labels.GetBufferedRegion().GetNumberOfPixels();
  const short *     from = bone.GetBufferPointer();
  short *           to = labels.GetBufferPointer();
  std::size_t       taken = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    taken += from[i] != 0 && to[i] != 0 ? 1 : 0;
    to[i] = to[i] == 0 && from[i] != 0 ? value : to[i];
  }
  return taken;
}

void
RunLabel(const LabelCommandOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, ImageExtensions() } });
  std::vector<LabelJob> jobs;
  for (const std::string & atlas : options.atlases)
  {
    jobs.push_back({ atlas, options.parameters.mirror });
  }
  for (const std::string & atlas : options.mirrored)
  {
    jobs.push_back({ atlas, MirrorMode::Always });
  }
  if (jobs.empty())
  {
    throw UsageError("no bone to find: give --atlas, or --mirrored for a bone of the other side");
  }
  session.Expect({ { "register", 1.0, static_cast<int>(jobs.size()) } });
  const CTImage::Pointer ct = ReadChosenCT(options.ct, options.series, session);
  auto                   labels = LabelImage::New();
  labels->CopyInformation(ct);
  labels->SetRegions(ct->GetBufferedRegion());
  labels->Allocate();
  labels->FillBuffer(0);
  short value = 0;
  for (const LabelJob & job : jobs)
  {
    AtlasVolumeParameters parameters = options.parameters;
    parameters.mirror = job.mirror;
    const auto        found = FindInCT(job.atlas, ct, parameters, session);
    const std::size_t taken = Paint(*found->GetLabelImage(), ++value, *labels);
    session.Print("  label " + std::to_string(value) + '\n');
    if (taken > 0)
    {
      session.WarnAlways(job.atlas + ": " + std::to_string(taken) +
                         " voxels are those of a bone found before, and stay so");
    }
  }
  WriteImage(labels, options.output);
}
} // namespace

void
AddLabelCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<LabelCommandOptions>();
  auto * command = app.add_subcommand("label", "A label map of a CT: bones found by their atlases");
  command->add_option("ct", options->ct, "CT: an image file, or the folder of a DICOM series")->required();
  AddSeriesOption(command, options->series);
  command->add_option(
    "--atlas", options->atlases, "Statistical models with density (.h5), of one bone each: labels 1, 2, ... in order");
  command->add_option("--mirrored",
                      options->mirrored,
                      "Statistical models whose mirror image is sought, for bones of the other side: the labels that "
                      "follow");
  AddParameterOptions(command, options->parameters);
  command->add_option("-o,--output", options->output, "Label map to write, on the CT's grid")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunLabel(*options, session); }; });
}
} // namespace bone
