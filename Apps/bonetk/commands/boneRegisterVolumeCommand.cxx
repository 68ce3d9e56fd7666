/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasInputs.h"
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneResultPage.h"

#include "boneAtomicFile.h"
#include "boneDeformablePosterior.h"
#include "boneMeshIO.h"
#include "boneRegistrationPage.h"
#include "boneRegistrationReport.h"
#include "boneTransformIO.h"

#include <chrono>
#include <filesystem>

namespace bone
{
namespace
{
struct RegisterVolumeOptions
{
  std::string           model;
  std::string           ct;
  std::string           series;
  AtlasVolumeParameters parameters;
  std::string           output;
  PageOption            page;
};

void
RunRegisterVolume(const RegisterVolumeOptions & options, Session & session)
{
  const auto          start = std::chrono::steady_clock::now();
  const std::string & output = options.output;
  VerifyOutputs({ { output + ".vtu", {} },
                  { output + "_labels.nii.gz", {} },
                  { output + ".tfm", {} },
                  { output + ".json", {} },
                  { output + "_posterior.h5", {} },
                  { options.page.NameOf(output), {} } });
  session.Expect({ { "reading", 1.0 }, { "register", 30.0 }, { "writing", 2.0 } });
  const CTImage::Pointer ct = [&] {
    const auto stage = session.BeginStage("reading");
    return ReadChosenCT(options.ct, options.series, session);
  }();
  const auto   registration = FindInCT(options.model, ct, options.parameters, session);
  const auto   stage = session.BeginStage("writing");
  const auto & result = registration->GetResult();
  WriteMeshArrays(result.mesh, output + ".vtu");
  WriteImage(registration->GetLabelImage(), output + "_labels.nii.gz");
  WriteRigidTransform(*result.pose.ToTransform(), output + ".tfm");
  WritePosterior(result.coefficients, result.covariance, result.pointDeviations, output + "_posterior.h5");
  nlohmann::json report = ReportRegistration(result);
  report["model"] = options.model;
  report["image"] = options.ct;
  report["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  WriteFileAtomically(output + ".json", report.dump(1) + "\n");
  if (options.page.IsOn())
  {
    std::vector<ParameterValue> parameters;
    AddParameters("registration", options.parameters, parameters);
    ReportPage page = MakeRegistrationPage(
      std::filesystem::path(output).filename().string(), "register volume", report, {}, result.mesh);
    WritePage(page,
              options.page.NameOf(output),
              session,
              std::move(parameters),
              { { "registration", report["seconds"].get<double>() } });
  }
}
} // namespace

void
AddRegisterVolumeCommand(CLI::App & group, Action & action)
{
  auto   options = std::make_shared<RegisterVolumeOptions>();
  auto * command = group.add_subcommand(
    "volume",
    "An atlas' bone in a CT without a label map; writes OUT.vtu, OUT_labels.nii.gz, OUT.tfm, OUT.json and "
    "OUT_posterior.h5");
  command->add_option("model", options->model, "Statistical model with density (.h5)")->required();
  command->add_option("ct", options->ct, "CT: an image file, or the folder of a DICOM series")->required();
  AddSeriesOption(command, options->series);
  AddParameterOptions(command, options->parameters);
  options->page.AddTo(command);
  command->add_option("-o,--output", options->output, "Beginning of the names of the files to write")->required();
  command->callback(
    [options, &action] { action = [options](Session & session) { RunRegisterVolume(*options, session); }; });
}
} // namespace bone
