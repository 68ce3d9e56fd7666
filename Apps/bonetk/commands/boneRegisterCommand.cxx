/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneRegistrationViews.h"

#include "boneRigidRadiographRegistration.h"

#include "boneAtomicFile.h"
#include "boneFileName.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneMeshIO.h"
#include "boneRegistrationPage.h"
#include "boneRegistrationReport.h"
#include "boneTransformIO.h"

#include <cstdio>
#include <filesystem>

namespace bone
{
namespace
{
using Hierarchy = DensityHierarchy<>;
using Registration = RigidRadiographRegistration<DensityMesh<double>, CTImage>;

struct RegisterRigidOptions
{
  std::vector<std::string>  models;
  RegistrationViewOptions   views;
  RigidRadiographParameters rigid;
  std::string               output;
};

Hierarchy::Pointer
ReadModel(const std::string & path)
{
  if (!HasExtension(path, ".vtu"))
  {
    return ReadHierarchy(path);
  }
  Hierarchy::Level level;
  level.mesh = ReadDensityMesh(path);
  auto hierarchy = Hierarchy::New();
  hierarchy->SetLevels({ level });
  return hierarchy;
}

/** OUT of the only body, OUT_B1, OUT_B2, ... of several. */
std::string
OutputOf(const RegisterRigidOptions & options, std::size_t body)
{
  return options.output + (options.models.size() > 1 ? "_B" + std::to_string(body + 1) : "");
}

void
PrintResult(const std::string & name, const RigidRegistrationResult & result, Session & session)
{
  const double  degree = 180.0 / std::acos(-1.0);
  const auto    sd = Eigen::VectorXd(result.covariance.diagonal().cwiseMax(0.0).cwiseSqrt());
  char          line[400];
  const Vector3 moved = result.pose.translation;
  const Vector3 turn =
    degree * RigidPose().StepTo({ result.pose.rotation, Vector3::Zero(), Vector3::Zero() }).tail<3>();
  std::snprintf(line,
                sizeof(line),
                "%s: %s, cost %.3f, distinctness %.2f, %d %s\n"
                "  centre moved by %8.2f %8.2f %8.2f mm (x, y, z), standard deviations %.2f %.2f %.2f mm\n"
                "  turned by       %8.2f %8.2f %8.2f degrees,      standard deviations %.2f %.2f %.2f degrees\n",
                name.c_str(),
                ParameterText(result.quality).c_str(),
                result.cost,
                result.distinctness,
                result.searches,
                result.searches == 1 ? "search" : "searches",
                moved.x(),
                moved.y(),
                moved.z(),
                sd[0],
                sd[1],
                sd[2],
                turn.x(),
                turn.y(),
                turn.z(),
                degree * sd[3],
                degree * sd[4],
                degree * sd[5]);
  session.Print(line);
}

bool
AreViewsMoved(const RigidRadiographParameters & parameters)
{
  return parameters.viewTranslationDeviation > 0.0 || parameters.viewRotationDeviation > 0.0;
}

std::string
GeometryNameOf(const RegisterRigidOptions & options)
{
  return options.output + "_geometry.json";
}

/** The views where they were found to be; OUT_geometry.json where that is not where they were said to be. */
std::vector<PreparedView>
CorrectViews(const RegisterRigidOptions &        options,
             std::vector<PreparedView>           views,
             const std::vector<ViewCorrection> & corrections)
{
  if (AreViewsMoved(options.rigid))
  {
    std::vector<XRayGeometry::Pointer> geometries;
    for (std::size_t v = 0; v < views.size(); ++v)
    {
      geometries.push_back(XRayGeometry::New());
      geometries.back()->SetView(corrections[v].motion.ToModelSpace(views[v].geometry->GetView()));
      views[v].geometry = geometries.back();
    }
    WriteGeometry(geometries, GeometryNameOf(options));
  }
  return views;
}

void
WriteRigidPage(const RegisterRigidOptions & options,
               unsigned int                 body,
               const nlohmann::json &       report,
               const std::vector<Canvas> &  pictures,
               const MeshArrays &           mesh,
               const Session &              session)
{
  std::vector<ParameterValue> parameters;
  AddParameters("registration", options.rigid, parameters);
  AddParameters("X-rays", options.views.preprocess, parameters);
  const std::string name = std::filesystem::path(options.models[body]).filename().string();
  ReportPage        page = MakeRegistrationPage(name, "register rigid", report, pictures, mesh);
  WritePage(page,
            options.views.page.NameOf(OutputOf(options, body)),
            session,
            std::move(parameters),
            { { "registration", report["seconds"].get<double>() } });
}

/** Files, lines and warnings of one body. */
void
ReportBody(const RegisterRigidOptions &      options,
           unsigned int                      body,
           const std::vector<PreparedView> & views,
           const Registration &              registration,
           const Hierarchy &                 model,
           double                            seconds,
           Session &                         session)
{
  const auto &      result = registration.GetResult(body);
  const std::string output = OutputOf(options, body);
  WriteRigidTransform(*registration.GetTransform(body), output + ".tfm");
  nlohmann::json report = ReportRegistration(result);
  report["model"] = options.models[body];
  report["xrays"] = options.views.xrays;
  report["seconds"] = seconds;
  if (AreViewsMoved(options.rigid))
  {
    report["viewCorrections"] = ReportViewCorrections(registration.GetViewCorrections());
  }
  WriteFileAtomically(output + ".json", report.dump(1) + "\n");
  const MeshArrays mesh = model.GetMesh(0)->GetArrays();
  const auto       pictures = WriteRegistrationPictures(views, mesh, result.pose, output);
  PrintResult(options.models[body], result, session);
  if (result.quality != RegistrationQuality::Ok)
  {
    session.WarnAlways(options.models[body] + ": the pose is " +
                       (result.quality == RegistrationQuality::Failed
                          ? "likely wrong: give a better --initial, landmarks, or a larger --search"
                          : "not distinct: look at the pictures"));
  }
  if (options.views.page.IsOn())
  {
    WriteRigidPage(options, body, report, pictures, mesh, session);
  }
}

void
RunRegisterRigid(const RegisterRigidOptions & options, Session & session)
{
  VerifyViewOptions(options.views);
  std::vector<OutputFile> files;
  for (std::size_t body = 0; body < options.models.size(); ++body)
  {
    const std::string output = OutputOf(options, body);
    files.push_back({ output + ".tfm", {} });
    files.push_back({ output + ".json", {} });
    files.push_back({ options.views.page.NameOf(output), {} });
    for (std::size_t v = 0; v < options.views.xrays.size(); ++v)
    {
      files.push_back({ PictureNameOf(output, v), {} });
    }
  }
  if (AreViewsMoved(options.rigid))
  {
    files.push_back({ GeometryNameOf(options), {} });
  }
  VerifyOutputs(files);
  RegisterRigidOptions chosen = options;
  ApplySearch(options.views, chosen.rigid);
  session.Expect({ { "reading", 1.0 }, { "register", 10.0 }, { "writing", 1.0 } });
  const auto views = [&] {
    const auto stage = session.BeginStage("reading");
    return ReadRegistrationViews(chosen.views, session);
  }();
  const auto start = std::chrono::steady_clock::now();
  auto       registration = Registration::New();
  registration->SetParameters(chosen.rigid);
  std::vector<Hierarchy::Pointer> models;
  for (const std::string & path : options.models)
  {
    models.push_back(ReadModel(path));
    registration->SetModel(static_cast<unsigned int>(models.size()) - 1, models.back());
  }
  ConnectViews(chosen.views, views, *registration, session);
  session.Watch(registration, "register");
  registration->Update();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto   stage = session.BeginStage("writing");
  const auto   corrected = CorrectViews(chosen, views, registration->GetViewCorrections());
  for (unsigned int body = 0; body < models.size(); ++body)
  {
    ReportBody(chosen, body, corrected, *registration, *models[body], seconds, session);
  }
}
} // namespace

void
AddRegisterCommand(CLI::App & app, Action & action)
{
  auto * group =
    app.add_subcommand("register", "Where a bone lies: a model or an atlas to X-rays, a CT or another bone");
  group->require_subcommand(1);
  auto   options = std::make_shared<RegisterRigidOptions>();
  auto * command = group->add_subcommand(
    "rigid", "Pose of density models in X-rays; writes OUT.tfm, OUT.json and pictures OUT_V1.png, ...");
  command
    ->add_option(
      "model,--model",
      options->models,
      "Model (.hierarchy.json, .vtu with a density in HU); several are bodies that the X-rays show together, each free "
      "to move, as OUT_B1, OUT_B2, ...")
    ->required();
  AddRegistrationViewOptions(command, options->views, "20 20");
  AddParameterOptions(command, options->rigid);
  command->add_option("-o,--output", options->output, "Beginning of the names of the files to write")->required();
  command->callback(
    [options, &action] { action = [options](Session & session) { RunRegisterRigid(*options, session); }; });
  AddRegisterDeformCommand(*group, action);
  AddRegisterVolumeCommand(*group, action);
  AddRegisterSubjectCommand(*group, action);
}
} // namespace bone
