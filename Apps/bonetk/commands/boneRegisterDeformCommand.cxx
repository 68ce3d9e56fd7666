/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneAtlasInputs.h"
#include "boneCommands.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneRegistrationViews.h"

#include "boneDeformableRadiographRegistration.h"

#include "boneAtomicFile.h"
#include "boneDeformablePosterior.h"
#include "boneIOError.h"
#include "boneMeshIO.h"
#include "boneModelIO.h"
#include "boneRegistrationPage.h"
#include "boneRegistrationReport.h"
#include "boneTransformIO.h"

#include <cstdio>
#include <filesystem>

namespace bone
{
namespace
{
struct RegisterDeformOptions
{
  std::string                    model;
  RegistrationViewOptions        views;
  DeformableRadiographParameters deformable;
  int                            samples{ 0 };
  std::string                    output;
};

/** OUT_S1.vtu, OUT_S2.vtu, ... */
std::string
SampleNameOf(const RegisterDeformOptions & options, int sample)
{
  return options.output + "_S" + std::to_string(sample + 1) + ".vtu";
}

/** Coefficients in standard deviations, the first few of them. */
std::string
LeadingCoefficients(const nlohmann::json & coefficients)
{
  constexpr std::size_t most = 6;
  std::string           text;
  for (std::size_t k = 0; k < std::min(most, coefficients.size()); ++k)
  {
    char number[32];
    std::snprintf(number, sizeof(number), " %.2f", coefficients[k].get<double>());
    text += number;
  }
  return coefficients.empty() ? " none" : text + (coefficients.size() > most ? " ..." : "");
}

void
PrintDeformation(const std::string & name, const nlohmann::json & report, Session & session)
{
  char line[300];
  std::snprintf(line,
                sizeof(line),
                "%s: %s, cost %.3f, points' standard deviation %.2f mm (largest %.2f mm)\n",
                name.c_str(),
                report["quality"].get<std::string>().c_str(),
                report["cost"].get<double>(),
                report["pointDeviation"]["mean"].get<double>(),
                report["pointDeviation"]["largest"].get<double>());
  session.Print(line + ("  shape" + LeadingCoefficients(report["shape"])) + "\n  density" +
                LeadingCoefficients(report["density"]) + "\n");
}

void
VerifyDeformOptions(const RegisterDeformOptions & options)
{
  VerifyViewOptions(options.views);
  if (options.views.xrays.size() == 1 && options.deformable.translationDeviation == 0.0)
  {
    throw UsageError(
      "one X-ray cannot tell size from depth: give --translation-deviation and --rotation-deviation, how "
      "well the start is known, or a second X-ray");
  }
  const std::string &     output = options.output;
  std::vector<OutputFile> files{ { output + ".vtu", {} },
                                 { output + ".tfm", {} },
                                 { output + ".json", {} },
                                 { output + "_posterior.h5", {} },
                                 { options.views.page.NameOf(output), {} } };
  for (int sample = 0; sample < options.samples; ++sample)
  {
    files.push_back({ SampleNameOf(options, sample), {} });
  }
  for (std::size_t v = 0; v < options.views.xrays.size(); ++v)
  {
    files.push_back({ PictureNameOf(output, v), {} });
  }
  VerifyOutputs(files);
}

void
WriteDeformPage(const RegisterDeformOptions &        options,
                const nlohmann::json &               report,
                const std::vector<Canvas> &          pictures,
                const DeformableRegistrationResult & result,
                const Session &                      session)
{
  MeshArrays bone = result.mesh;
  for (Vector3 & x : bone.points)
  {
    x = result.pose.rotation.transpose() * x; // turned as the atlas is, whose space is the patient's
  }
  std::vector<ParameterValue> parameters;
  AddParameters("registration", options.deformable, parameters);
  AddParameters("X-rays", options.views.preprocess, parameters);
  const std::string name = std::filesystem::path(options.output).filename().string();
  ReportPage        page = MakeRegistrationPage(name, "register deform", report, pictures, bone);
  WritePage(page,
            options.views.page.NameOf(options.output),
            session,
            std::move(parameters),
            { { "registration", report["seconds"].get<double>() } });
}

void
RunRegisterDeform(const RegisterDeformOptions & options, Session & session)
{
  const auto start = std::chrono::steady_clock::now();
  VerifyDeformOptions(options);
  DeformableRadiographParameters parameters = options.deformable;
  ApplySearch(options.views, parameters);
  session.Expect({ { "reading", 1.0 }, { "register", 20.0 }, { "writing", 1.0 } });
  auto       reading = std::make_unique<Session::Stage>(session, "reading");
  const auto atlas = ReadAtlasWithDensity(options.model);
  const auto views = ReadRegistrationViews(options.views, session);
  reading.reset();
  if (parameters.intensities &&
      std::any_of(views.begin(), views.end(), [](const PreparedView & view) { return view.monotoneOnly; }))
  {
    parameters.intensities = false;
    session.Warn("display values are no line integrals: the X-rays' gradients alone are used, which tell little of "
                 "density");
  }
  auto registration = DeformableRadiographRegistration<DensityMesh<double>, CTImage>::New();
  registration->SetModel(atlas);
  registration->SetParameters(parameters);
  ConnectViews(options.views, views, *registration, session);
  session.Watch(registration, "register");
  registration->Update();

  const auto   stage = session.BeginStage("writing");
  const auto & result = registration->GetResult();
  WriteMeshArrays(result.mesh, options.output + ".vtu");
  WriteRigidTransform(*registration->GetTransform(), options.output + ".tfm");
  WritePosterior(result.coefficients, result.covariance, result.pointDeviations, options.output + "_posterior.h5");
  if (options.samples > 0)
  {
    const DeformablePosterior posterior(atlas->GetContent(), parameters, result);
    for (int sample = 0; sample < options.samples; ++sample)
    {
      WriteMeshArrays(posterior.Draw(static_cast<std::uint64_t>(parameters.seed) + static_cast<std::uint64_t>(sample)),
                      SampleNameOf(options, sample));
    }
  }
  nlohmann::json report = ReportRegistration(result);
  report["model"] = options.model;
  report["xrays"] = options.views.xrays;
  report["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  WriteFileAtomically(options.output + ".json", report.dump(1) + "\n");
  // The mesh lies in the views' space: the patient is turned there as the atlas was.
  const auto pictures =
    WriteRegistrationPictures(views, result.mesh, RigidPose(), options.output, result.pose.rotation);
  PrintDeformation(options.model, report, session);
  if (result.quality != RegistrationQuality::Ok)
  {
    session.WarnAlways(options.model + ": the bone found is " +
                       (result.quality == RegistrationQuality::Failed
                          ? "likely wrong: give a better --initial, landmarks, or a larger --search"
                          : "not distinct: look at the pictures"));
  }
  if (options.views.page.IsOn())
  {
    WriteDeformPage(options, report, pictures, result, session);
  }
}
} // namespace

void
AddRegisterDeformCommand(CLI::App & group, Action & action)
{
  auto   options = std::make_shared<RegisterDeformOptions>();
  auto * command = group.add_subcommand("deform",
                                        "Pose, shape and density of an atlas' bone in X-rays; writes OUT.vtu, OUT.tfm, "
                                        "OUT.json, OUT_posterior.h5 and pictures OUT_V1.png, ...");
  command->add_option("model", options->model, "Statistical model with density (.h5)")->required();
  AddRegistrationViewOptions(command, options->views, "10 10");
  AddParameterOptions(command, options->deformable);
  command
    ->add_option("--samples",
                 options->samples,
                 "Bones to draw from what the X-rays leave open, as OUT_S1.vtu, OUT_S2.vtu, ...; their cells may be "
                 "inverted where little is known")
    ->check(CLI::Range(0, 10000).description(""))
    ->capture_default_str();
  command->add_option("-o,--output", options->output, "Beginning of the names of the files to write")->required();
  command->callback(
    [options, &action] { action = [options](Session & session) { RunRegisterDeform(*options, session); }; });
}
} // namespace bone
