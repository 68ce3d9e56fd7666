/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneRigidRadiographRegistration.h"

#include "boneAtomicFile.h"
#include "boneFileName.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneMeshIO.h"
#include "bonePoseInitializer.h"
#include "boneRadiographPreprocessFilter.h"
#include "boneRegistrationReport.h"
#include "boneTransformIO.h"
#include "boneXRayConventions.h"
#include "boneXRayIO.h"

#include <cstdio>

namespace bone
{
namespace
{
using Hierarchy = DensityHierarchy<>;
using Registration = RigidRadiographRegistration<DensityMesh<double>, CTImage>;

struct RegisterOptions
{
  std::vector<std::string>       models;
  std::vector<std::string>       xrays;
  std::string                    geometry;
  std::vector<double>            carm;
  CArmView                       distances;
  std::vector<std::string>       masks;
  std::string                    initial;
  std::string                    landmarks;
  std::vector<std::string>       imageLandmarks;
  std::vector<double>            search;
  CLI::Option *                  valuesOption{ nullptr };
  CLI::Option *                  cropOption{ nullptr };
  RadiographPreprocessParameters preprocess;
  PoseInitializerParameters      initializer;
  RigidRadiographParameters      rigid;
  std::string                    output;
};

/** An X-ray made ready. */
struct PreparedView
{
  XRayGeometry::Pointer geometry;
  CTImage::Pointer      integrals;
  CTImage::Pointer      weights;
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

/** The geometry of each X-ray: of the file of views, of the C-arm's angles, or of the X-rays themselves. */
std::vector<XRayGeometry::Pointer>
GeometryOf(const RegisterOptions & options, const std::vector<XRayFile> & files)
{
  std::vector<XRayGeometry::Pointer> views;
  if (!options.geometry.empty())
  {
    views = ReadGeometry(options.geometry);
    if (views.size() != files.size())
    {
      throw UsageError(options.geometry + " has " + std::to_string(views.size()) + " views, but there are " +
                       std::to_string(files.size()) + " X-rays");
    }
    return views;
  }
  for (std::size_t v = 0; v < files.size(); ++v)
  {
    XRayGeometry::View view;
    if (!options.carm.empty())
    {
      CArmView   arm = options.distances;
      const auto size = files[v].image->GetLargestPossibleRegion().GetSize();
      arm.primary = options.carm[2 * v];
      arm.secondary = options.carm[2 * v + 1];
      arm.size = { { static_cast<int>(size[0]), static_cast<int>(size[1]) } };
      arm.spacing = { files[v].image->GetSpacing()[0], files[v].image->GetSpacing()[1] };
      view = FromCArm(arm);
    }
    else if (files[v].view)
    {
      view = *files[v].view;
    }
    else
    {
      std::string reasons;
      for (const std::string & obstacle : files[v].obstacles)
      {
        reasons += (reasons.empty() ? " (" : "; ") + obstacle;
      }
      throw UsageError(options.xrays[v] + " does not say how it was taken" + reasons + (reasons.empty() ? "" : ")") +
                       ": give --geometry or --carm");
    }
    views.push_back(XRayGeometry::New());
    views.back()->SetView(view);
  }
  return views;
}

std::vector<PreparedView>
ReadViews(const RegisterOptions & options, Session & session)
{
  std::vector<XRayFile> files;
  for (const std::string & path : options.xrays)
  {
    files.push_back(ReadXRay(path));
    for (const std::string & note : files.back().notes)
    {
      session.Warn(path + ": " + note);
    }
  }
  const auto                geometry = GeometryOf(options, files);
  std::vector<PreparedView> views;
  for (std::size_t v = 0; v < files.size(); ++v)
  {
    auto preprocess = RadiographPreprocessFilter<CTImage, CTImage, LabelImage>::New();
    preprocess->SetInput(files[v].image);
    preprocess->SetParameters(options.preprocess);
    if (options.valuesOption->count() == 0)
    {
      preprocess->SetValues(files[v].values);
      preprocess->SetLargerAttenuates(files[v].largerAttenuates);
    }
    if (options.cropOption->count() == 0)
    {
      preprocess->SetCrop(files[v].crop);
    }
    if (v < options.masks.size())
    {
      const auto mask = ReadRadiograph(options.masks[v]);
      auto       labels = LabelImage::New();
      labels->CopyInformation(mask);
      labels->SetRegions(mask->GetLargestPossibleRegion());
      labels->Allocate();
      std::transform(mask->GetBufferPointer(),
                     mask->GetBufferPointer() + mask->GetLargestPossibleRegion().GetNumberOfPixels(),
                     labels->GetBufferPointer(),
                     [](float x) { return static_cast<short>(x != 0.0f); });
      preprocess->SetMask(labels);
    }
    try
    {
      preprocess->Update();
    }
    catch (const itk::ExceptionObject & error)
    {
      throw IOError(options.xrays[v], ErrorLine(error));
    }
    views.push_back({ geometry[v], preprocess->GetOutput(), preprocess->GetWeights() });
  }
  return views;
}

/** Where the search begins: the transform given, what landmarks say, or the model as it lies. */
itk::Euler3DTransform<double>::Pointer
InitialTransform(const RegisterOptions & options, const std::vector<PreparedView> & views, Session & session)
{
  itk::Euler3DTransform<double>::Pointer initial;
  if (!options.initial.empty())
  {
    initial = ReadRigidTransform(options.initial);
  }
  if (options.landmarks.empty())
  {
    return initial;
  }
  std::vector<XRayGeometry::View>         geometry;
  std::vector<std::vector<ImageLandmark>> seen;
  for (std::size_t v = 0; v < views.size(); ++v)
  {
    geometry.push_back(views[v].geometry->GetView());
    seen.push_back(v < options.imageLandmarks.size() ? ReadImageLandmarks(options.imageLandmarks[v], geometry[v])
                                                     : std::vector<ImageLandmark>());
  }
  std::optional<PosePrior> prior;
  if (initial.IsNotNull())
  {
    prior = PosePrior{ RigidPose::FromTransform(*initial) };
  }
  const auto pairs = MatchLandmarks(ReadLandmarks(options.landmarks), seen);
  const auto estimate = EstimatePose(geometry, pairs, options.initializer, prior);
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    if (!estimate.inlier[i])
    {
      session.Warn("landmark " + pairs[i].name + " of view " + std::to_string(pairs[i].view + 1) +
                   " does not fit the others and is left out");
    }
  }
  if (estimate.ambiguous)
  {
    session.Warn("the landmarks fit another pose about as well: give more of them, or --initial");
  }
  return estimate.pose.ToTransform();
}

/** OUT of the only body, OUT_B1, OUT_B2, ... of several. */
std::string
OutputOf(const RegisterOptions & options, std::size_t body)
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

void
RegisterBody(const RegisterOptions &           options,
             std::size_t                       body,
             const std::vector<PreparedView> & views,
             Session &                         session)
{
  const auto start = std::chrono::steady_clock::now();
  const auto model = ReadModel(options.models[body]);
  auto       registration = Registration::New();
  registration->SetModel(model);
  registration->SetParameters(options.rigid);
  for (unsigned int v = 0; v < views.size(); ++v)
  {
    registration->SetView(v, views[v].integrals, views[v].geometry, views[v].weights);
  }
  if (const auto initial = InitialTransform(options, views, session))
  {
    registration->SetInitialTransform(initial);
  }
  session.Watch(registration, "register");
  registration->Update();
  const auto &      result = registration->GetResult();
  const std::string output = OutputOf(options, body);
  WriteRigidTransform(*registration->GetTransform(), output + ".tfm");
  nlohmann::json report = ReportRegistration(result);
  report["model"] = options.models[body];
  report["xrays"] = options.xrays;
  report["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  WriteFileAtomically(output + ".json", report.dump(1) + "\n");
  for (std::size_t v = 0; v < views.size(); ++v)
  {
    const float *  pixels = views[v].integrals->GetBufferPointer();
    const float *  weights = views[v].weights->GetBufferPointer();
    RadiographView xray;
    xray.view = views[v].geometry->GetView();
    xray.values.assign(pixels, pixels + xray.GetNumberOfPixels());
    xray.weights.assign(weights, weights + xray.GetNumberOfPixels());
    WriteImage(DrawRegistration(xray, model->GetMesh(0)->GetArrays(), result.pose).GetPointer(),
               output + "_V" + std::to_string(v + 1) + ".png");
  }
  PrintResult(options.models[body], result, session);
  if (result.quality != RegistrationQuality::Ok)
  {
    session.WarnAlways(options.models[body] + ": the pose is " +
                       (result.quality == RegistrationQuality::Failed
                          ? "likely wrong: give a better --initial, landmarks, or a larger --search"
                          : "not distinct: look at the pictures"));
  }
}

void
RunRegisterRigid(const RegisterOptions & options, Session & session)
{
  if (!options.masks.empty() && options.masks.size() != options.xrays.size())
  {
    throw UsageError("give as many --mask as --xray");
  }
  if (!options.carm.empty() && options.carm.size() != 2 * options.xrays.size())
  {
    throw UsageError("--carm needs a primary and a secondary angle for each --xray");
  }
  if (options.imageLandmarks.size() > options.xrays.size())
  {
    throw UsageError("there are more --xray-landmarks than --xray");
  }
  std::vector<OutputFile> files;
  for (std::size_t body = 0; body < options.models.size(); ++body)
  {
    const std::string output = OutputOf(options, body);
    files.push_back({ output + ".tfm", {} });
    files.push_back({ output + ".json", {} });
    for (std::size_t v = 0; v < options.xrays.size(); ++v)
    {
      files.push_back({ output + "_V" + std::to_string(v + 1) + ".png", {} });
    }
  }
  VerifyOutputs(files);
  RegisterOptions chosen = options;
  if (!options.search.empty())
  {
    chosen.rigid.searchTranslation = options.search[0];
    chosen.rigid.searchRotation = options.search[1];
  }
  const auto views = ReadViews(chosen, session);
  for (std::size_t body = 0; body < options.models.size(); ++body)
  {
    RegisterBody(chosen, body, views, session);
  }
}

void
AddViewOptions(CLI::App * command, RegisterOptions & options)
{
  command->add_option("--xray", options.xrays, "X-rays: DICOM, or images of columns x rows pixels")->required();
  auto * geometry = command->add_option("--geometry", options.geometry, "Views of the X-rays, in their order (.json)");
  auto * carm = command
                  ->add_option("--carm",
                               options.carm,
                               "C-arm's primary (LAO positive) and secondary angle (CRA positive) of each X-ray, "
                               "degrees; isocentre at the origin")
                  ->excludes(geometry);
  command->add_option("--source-isocentre", options.distances.sourceToIsocenter, "Source to isocentre, mm; default 700")
    ->check(Length())
    ->needs(carm);
  command->add_option("--source-detector", options.distances.sourceToDetector, "Source to detector, mm; default 1000")
    ->check(Length())
    ->needs(carm);
  command->add_option("--mask", options.masks, "Images of the X-rays' sizes: pixels that are 0 do not count");
  AddParameterOptions(command, options.preprocess);
  options.valuesOption = command->get_option("--xray-values");
  options.cropOption = command->get_option("--crop");
}
} // namespace

void
AddRegisterCommand(CLI::App & app, Action & action)
{
  auto * group = app.add_subcommand("register", "Where a bone lies: a model to X-rays");
  group->require_subcommand(1);
  auto   options = std::make_shared<RegisterOptions>();
  auto * command = group->add_subcommand(
    "rigid", "Pose of density models in X-rays; writes OUT.tfm, OUT.json and pictures OUT_V1.png, ...");
  command
    ->add_option(
      "model,--model",
      options->models,
      "Model (.hierarchy.json, .vtu with a density in HU); several are registered each by itself, as OUT_B1, "
      "OUT_B2, ...")
    ->required();
  AddViewOptions(command, *options);
  command->add_option(
    "--initial", options->initial, "Transform from the model's space to the views' to begin with (.tfm)");
  auto * landmarks =
    command->add_option("--landmarks", options->landmarks, "Landmarks of the model, to begin with (.mrk.json, .json)");
  command
    ->add_option("--xray-landmarks",
                 options->imageLandmarks,
                 "The same landmarks on each X-ray (.mrk.json, or .json with columns and rows)")
    ->needs(landmarks);
  landmarks->needs("--xray-landmarks");
  AddParameterOptions(command, options->initializer);
  command
    ->add_option(
      "--search",
      options->search,
      "How far the start may be off: mm along each axis, degrees about each; default 20 20; 0 0: refine only")
    ->expected(2)
    ->check(NotNegative());
  AddParameterOptions(command, options->rigid);
  command->add_option("-o,--output", options->output, "Beginning of the names of the files to write")->required();
  command->callback(
    [options, &action] { action = [options](Session & session) { RunRegisterRigid(*options, session); }; });
}
} // namespace bone
