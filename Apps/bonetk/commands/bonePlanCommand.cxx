/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneMeasureOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneAtomicFile.h"
#include "boneMeasureReport.h"
#include "bonePathPlan.h"
#include "boneResectionPlan.h"

namespace bone
{
namespace
{
struct PlanOptions
{
  std::string         model;
  std::vector<double> resections, paths;
  double              radius{ 0.0 };
  bool                search{ false };
  PathPlanParameters  parameters;
  std::string         output;
};

void
RunPlan(const PlanOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".json" } } });
  if (options.resections.empty() && options.paths.empty())
  {
    throw UsageError("nothing to plan: give --resection or --path");
  }
  RequireNumbersEach("--resection", options.resections, 6);
  RequireNumbersEach("--path", options.paths, 6);
  if (options.paths.empty() != (options.radius == 0.0))
  {
    throw UsageError("--path and --radius go together");
  }
  const auto       point = [](const double * x) { return Vector3(x[0], x[1], x[2]); };
  const MeshArrays model = ReadFirstLevel(options.model);
  MeasureReport    report;
  for (std::size_t i = 0; i < options.resections.size(); i += 6)
  {
    const double * x = options.resections.data() + i;
    if (point(x + 3).norm() == 0.0)
    {
      throw UsageError("--resection: the normal must not be 0 0 0");
    }
    report.list.Append(PlanResection(model, point(x), point(x + 3), "resection" + std::to_string(i / 6 + 1)));
  }
  for (std::size_t i = 0; i < options.paths.size(); i += 6)
  {
    const double * x = options.paths.data() + i;
    if (point(x) == point(x + 3))
    {
      throw UsageError("--path: its ends must not be one point");
    }
    const std::string name = "path" + std::to_string(i / 6 + 1);
    const MeasureList list =
      PlanPath(model, { point(x), point(x + 3), options.radius }, options.search, options.parameters, name);
    for (const Measure & measure : list.measures)
    {
      if (measure.name == name + ".search" && measure.text == "none")
      {
        session.WarnAlways(name + ": no path within the bounds of the search is safe; the one given is assessed");
      }
    }
    report.list.Append(list);
  }
  PrintMeasures(report, session);
  nlohmann::json json = ReportMeasures(report);
  json.erase("landmarks");
  json["model"] = options.model;
  WriteFileAtomically(options.output, json.dump(2) + '\n');
}
} // namespace

void
AddPlanCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<PlanOptions>();
  auto * command =
    app.add_subcommand("plan", "Resections and paths of screws or stems: what they remove, meet and leave");
  command->add_option("model", options->model, "Model with a density (.vtu, .hierarchy.json)")->required();
  command
    ->add_option("--resection",
                 options->resections,
                 "Plane: x y z of a point in mm, x y z toward what is removed; may be repeated")
    ->type_size(6)
    ->expected(1, 1000)
    ->allow_extra_args(false);
  command
    ->add_option("--path", options->paths, "Path: x y z where it enters, x y z where it ends, in mm; may be repeated")
    ->type_size(6)
    ->expected(1, 1000)
    ->allow_extra_args(false);
  command->add_option("--radius", options->radius, "Radius of the paths in mm")->check(Length());
  command->add_flag(
    "--search", options->search, "Take the safe path with the densest bone around it near each path given");
  AddParameterOptions(command, options->parameters);
  command->add_option("-o,--output", options->output, "Plan to write (.json)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunPlan(*options, session); }; });
}
} // namespace bone
