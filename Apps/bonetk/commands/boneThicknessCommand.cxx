/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneMeasureOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneAtomicFile.h"
#include "boneCorticalThicknessFilter.h"
#include "boneMeshIO.h"

#include <iomanip>
#include <sstream>

namespace bone
{
namespace
{
struct ThicknessOptions
{
  std::string                 model;
  std::string                 ct;
  std::string                 series;
  CorticalThicknessParameters parameters;
  std::string                 report;
  std::string                 output;
};

std::string
Describe(const nlohmann::json & report)
{
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  if (report.contains("thickness"))
  {
    const nlohmann::json & thickness = report["thickness"];
    const auto             of = [&](const char * name) { return thickness[name].get<double>(); };
    text << "cortical thickness: mean " << of("mean") << " mm, median " << of("median") << " mm, 5 to 95 percentile "
         << of("percentile5") << " to " << of("percentile95") << " mm\n";
  }
  text << "without a result: " << std::setprecision(1) << 100.0 * (1.0 - report["shareOfArea"]["found"].get<double>())
       << " % of the surface\n"
       << std::setprecision(2)
       << "blur (full width at half maximum): " << report["pointSpread"]["inPlane"].get<double>()
       << " mm in the slices' plane, " << report["pointSpread"]["across"].get<double>() << " mm across\n"
       << std::setprecision(0) << "density of thin cortex: " << report["corticalDensity"].get<double>() << " HU\n";
  return text.str();
}

void
RunThickness(const ThicknessOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".vtp" } }, { options.report, { ".json" } } });
  const auto ct = ReadChosenCT(options.ct, options.series, session);
  auto       mesh = DensityMesh<double>::New();
  mesh->SetArrays(ReadFirstLevel(options.model));
  auto filter = CorticalThicknessFilter<CTImage>::New();
  filter->SetMesh(mesh);
  filter->SetImage(ct);
  filter->SetParameters(options.parameters);
  session.Watch(filter, "thickness");
  filter->Update();
  const CorticalThicknessMap & map = filter->GetMap();
  std::vector<int>             status;
  for (const CorticalStatus of : map.status)
  {
    status.push_back(static_cast<int>(of));
  }
  WriteTriangleSurface(
    map.surface,
    { { "CorticalThickness", map.thickness }, { "CorticalDensity", map.density }, { "CorticalStatus", status } },
    options.output);
  nlohmann::json report = ReportThickness(map);
  session.Print(Describe(report));
  if (!options.report.empty())
  {
    report["model"] = options.model;
    report["ct"] = options.ct;
    WriteFileAtomically(options.report, report.dump(2) + '\n');
  }
}
} // namespace

void
AddThicknessCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<ThicknessOptions>();
  auto * command =
    app.add_subcommand("thickness", "Cortical thickness at the points of a model's surface, from the CT");
  command->add_option("model", options->model, "Model (.vtu, .hierarchy.json)")->required();
  command->add_option("ct", options->ct, "CT in HU that the model was made of: any image, or a folder of DICOM files")
    ->required();
  AddSeriesOption(command, options->series);
  AddParameterOptions(command, options->parameters);
  command->add_option("--report", options->report, "Summary to write (.json)");
  command
    ->add_option("-o,--output",
                 options->output,
                 "Surface to write (.vtp), with CorticalThickness (mm), CorticalDensity (HU) and CorticalStatus")
    ->required();
  command->callback([options, &action] { action = [options](Session & session) { RunThickness(*options, session); }; });
}
} // namespace bone
