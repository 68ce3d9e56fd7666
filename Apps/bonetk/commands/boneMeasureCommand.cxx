/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneMeasureOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"
#include "boneResultPage.h"

#include "boneAtomicFile.h"
#include "boneFileName.h"
#include "boneLandmarkIO.h"
#include "boneMeasurePage.h"
#include "boneMeshIO.h"

#include <filesystem>

namespace bone
{
namespace
{
struct MeasureOptions
{
  std::string         model;
  std::string         landmarks;
  std::string         standard;
  std::vector<double> balls, cylinders, capsules, halfSpaces;
  MeasureParameters   parameters;
  std::string         output;
  std::string         landmarksOutput;
  PageOption          page;
};

bool
IsSurface(const std::string & path)
{
  return HasExtension(path, ".ply") || HasExtension(path, ".stl") || HasExtension(path, ".vtp");
}

std::vector<NamedSolid>
ReadSolids(const MeasureOptions & options)
{
  std::vector<NamedSolid> solids;
  const auto              add = [&solids](SolidShape shape, const std::vector<double> & numbers, const char * option) {
    RequireNumbersEach(option, numbers, NumbersOfSolid(shape));
    const auto named = NameSolids(shape, numbers);
    solids.insert(solids.end(), named.begin(), named.end());
  };
  try
  {
    add(SolidShape::Ball, options.balls, "--ball");
    add(SolidShape::Cylinder, options.cylinders, "--cylinder");
    add(SolidShape::Capsule, options.capsules, "--capsule");
    add(SolidShape::HalfSpace, options.halfSpaces, "--half-space");
  }
  catch (const std::invalid_argument & error)
  {
    throw UsageError(error.what());
  }
  return solids;
}

std::vector<Landmark>
ReadGivenLandmarks(const MeasureOptions & options, const MeshArrays & model)
{
  if (options.landmarks.empty())
  {
    return {};
  }
  const auto landmarks = ReadLandmarks(options.landmarks);
  return options.standard.empty() ? landmarks : CarryLandmarks(ReadFirstLevel(options.standard), landmarks, model);
}

void
WriteMeasurePage(const MeasureOptions & options,
                 const MeasureReport &  report,
                 const MeshArrays &     model,
                 const Session &        session)
{
  std::vector<ParameterValue> parameters;
  AddParameters("measure", options.parameters, parameters);
  ReportPage page = MakeMeasurePage(std::filesystem::path(options.model).filename().string(), report, model);
  WritePage(page, options.page.NameOf(options.output), session, std::move(parameters), {});
}

void
RunMeasure(const MeasureOptions & options, Session & session)
{
  const auto solids = ReadSolids(options);
  const bool surface = IsSurface(options.model);
  if (surface && !(solids.empty() && options.standard.empty()))
  {
    throw UsageError(
      "a surface has no density and no topology to carry landmarks by: solids and --standard need a model");
  }
  if (options.landmarks.empty() && !(options.standard.empty() && options.landmarksOutput.empty()))
  {
    throw UsageError("--standard and --write-landmarks need --landmarks");
  }
  VerifyOutputs({ { options.output, { ".json" } },
                  { options.landmarksOutput, { ".mrk.json" } },
                  { options.page.NameOf(options.output), {} } });
  MeasureReport report;
  MeshArrays    model;
  if (surface)
  {
    report =
      MeasureSurface(ReadTriangleSurface(options.model), ReadGivenLandmarks(options, MeshArrays()), options.parameters);
  }
  else
  {
    model = ReadFirstLevel(options.model);
    report = MeasureModel(model, ReadGivenLandmarks(options, model), solids, options.parameters);
  }
  PrintMeasures(report, session);
  nlohmann::json json = ReportMeasures(report);
  json["model"] = options.model;
  WriteFileAtomically(options.output, json.dump(2) + '\n');
  if (!options.landmarksOutput.empty())
  {
    WriteLandmarks(report.landmarks, options.landmarksOutput);
  }
  if (options.page.IsOn())
  {
    WriteMeasurePage(options, report, model, session);
  }
}
} // namespace

void
AddMeasureCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<MeasureOptions>();
  auto * command =
    app.add_subcommand("measure", "Landmarks and measures of a model, each with value, unit and definition");
  command
    ->add_option(
      "model", options->model, "Model (.vtu, .hierarchy.json), or a closed surface (.ply, .stl, .vtp) without density")
    ->required();
  command->add_option(
    "--landmarks",
    options->landmarks,
    "Landmarks (.mrk.json): femoral_head, femoral_neck, shaft_proximal, shaft_distal, medial_condyle and "
    "lateral_condyle for a femur's measures, acetabulum, asis and pubic_tubercle for a hemipelvis'; see the guide");
  command->add_option("--standard",
                      options->standard,
                      "Model of the same topology that the landmarks were placed on; they are carried to the model");
  const auto solid = [command](const char * name, std::vector<double> & numbers, int each, const char * help) {
    command->add_option(name, numbers, help)->type_size(each)->expected(1, 1000)->allow_extra_args(false);
  };
  solid("--ball", options->balls, 4, "Ball to measure: x y z radius, in mm; may be repeated");
  solid("--cylinder", options->cylinders, 7, "Cylinder: x y z of one end, x y z of the other, radius");
  solid("--capsule", options->capsules, 7, "The same with round ends beyond");
  solid("--half-space", options->halfSpaces, 6, "Half-space: x y z of a point of its plane, x y z into it");
  AddParameterOptions(command, options->parameters);
  command->add_option("-o,--output", options->output, "Report to write (.json)")->required();
  command->add_option("--write-landmarks", options->landmarksOutput, "Landmarks on the model to write (.mrk.json)");
  options->page.AddTo(command);
  command->callback([options, &action] { action = [options](Session & session) { RunMeasure(*options, session); }; });
}
} // namespace bone
