/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneBuildPipeline.h"
#include "boneContourIO.h"
#include "boneCorrespondenceIO.h"
#include "boneMeshIO.h"

namespace bone
{
namespace
{
struct MeshOptions
{
  std::string      contours;
  std::string      ct;
  std::string      series;
  TilingParameters parameters;
  std::string      correspondence;
  std::string      correspondenceOutput;
  std::string      output;
};

void
RunMesh(const MeshOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".vtu" } }, { options.correspondenceOutput, { ".json" } } });
  if (options.ct.empty() && options.parameters.metric == TilingMetricKind::Density)
  {
    throw UsageError("--metric density needs --ct");
  }
  auto tiling = ContourTilingMeshSource<DensityMesh<double>>::New();
  tiling->SetInput(ReadContours(options.contours));
  tiling->SetParameters(options.parameters);
  if (!options.correspondence.empty())
  {
    tiling->SetCorrespondence(std::make_shared<ContourCorrespondence>(ReadCorrespondence(options.correspondence)));
  }
  if (!options.ct.empty())
  {
    tiling->SetDensityImage(ReadChosenCT(options.ct, options.series, session));
  }
  else if (options.parameters.metric == TilingMetricKind::Combined)
  {
    session.Print("no --ct: the combined metric is span length alone\n");
  }
  session.Watch(tiling, "tiling");
  tiling->Update();
  for (const std::string & warning : DescribeLosses(tiling->GetReport()))
  {
    session.Warn(warning);
  }
  WriteDensityMesh(tiling->GetOutput(), options.output);
  if (!options.correspondenceOutput.empty())
  {
    WriteCorrespondence(tiling->GetReport().correspondence, options.correspondenceOutput);
  }
}
} // namespace

void
AddMeshCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<MeshOptions>();
  auto * command = app.add_subcommand("mesh", "Tile contours into a layered tetrahedral mesh");
  command->add_option("contours", options->contours, "Contours (.vtp)")->required();
  command->add_option("--ct", options->ct, "CT whose density the metric follows");
  AddSeriesOption(command, options->series);
  AddParameterOptions(command, options->parameters);
  command->add_option("--correspondence",
                      options->correspondence,
                      "Which contours of neighbouring slices belong together (.json), where they do not as found");
  command->add_option("--write-correspondence",
                      options->correspondenceOutput,
                      "Where to write which contours were taken to belong together (.json)");
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunMesh(*options, session); }; });
}
} // namespace bone
