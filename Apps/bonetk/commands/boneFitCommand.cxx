/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneAtomicFile.h"
#include "boneDensityCalibration.h"
#include "boneDensityEvaluation.h"
#include "boneDensityFitFilter.h"
#include "boneMeshIO.h"

#include <nlohmann/json.hpp>

#include <map>

namespace bone
{
namespace
{
using Fit = DensityFitFilter<CTImage>;
using Json = nlohmann::ordered_json;

struct FitOptions
{
  std::string           ct;
  std::string           series;
  std::string           mesh;
  DensityFitParameters  parameters;
  MeshStorageParameters storage;
  std::string           weights;
  std::string           report;
  std::string           output;
};

/** Error at voxel centres of the mesh; with `heldOut` at those that IsHeldOut() alone. */
Json
ErrorAtVoxels(const MeshArrays & mesh, const CTImage & ct, bool heldOut)
{
  const VoxelGrid   grid = MakeVoxelGrid(ct, ct.GetBufferedRegion());
  const std::size_t row = grid.size[0], slice = row * grid.size[1];
  const float *     values = ct.GetBufferPointer();
  const auto        error = CompareDensity(mesh, grid, [&](std::size_t v, double & value) {
    value = values[v];
    const auto i = static_cast<int>(v % row), j = static_cast<int>(v % slice / row), k = static_cast<int>(v / slice);
    return !heldOut || IsHeldOut(i, j, k);
  });
  return { { "voxels", error.voxels },
           { "meanAbsolute", error.meanAbsolute },
           { "rootMeanSquare", error.rootMeanSquare },
           { "bias", error.bias },
           { "percentOfRange", error.meanAbsolutePercent } };
}

Json
DescribeFit(Fit & fit, const CTImage & ct)
{
  const MeshArrays         mesh = fit.GetOutput()->GetArrays();
  const DensityFitReport & found = fit.GetReport();
  Json                     report;
  report["quantity"] = DensityQuantityName(mesh.quantity);
  report["tetrahedra"] = mesh.tetrahedra.size();
  std::map<std::string, std::size_t> degrees;
  for (const int degree : mesh.degree)
  {
    ++degrees[std::to_string(degree)];
  }
  report["tetrahedraByDegree"] = degrees;
  report["coefficients"] = fit.GetNumberOfFreeCoefficients();
  for (const RegionDensity & region : MeasureRegions(mesh))
  {
    report["regions"].push_back({ { "region", region.region },
                                  { "tetrahedra", region.tetrahedra },
                                  { "volume", region.volume },
                                  { "mass", region.mass },
                                  { "mean", region.mean },
                                  { "standardDeviation", region.standardDeviation } });
  }
  report["tetrahedraWithFewerVoxelsThanCoefficients"] = found.sparse;
  report["tetrahedraWithoutWeight"] = found.unsupported;
  report["shareOfSamplesOutsideTheImage"] = fit.GetOutsideFraction();
  report["shareOfTheOutlineBrighterInside"] = fit.GetContrast().GetBrighterShare();
  report["overshoot"] = { { "median", found.overshootMedian },
                          { "percentile90", found.overshoot90 },
                          { "largest", found.overshootMaximum },
                          { "tetrahedraLimited", found.limited } };
  report["error"] = ErrorAtVoxels(mesh, ct, false);
  auto blind = Fit::New();
  blind->SetImage(&ct);
  blind->SetMesh(fit.GetMesh());
  blind->SetWeights(fit.GetWeights());
  blind->SetParameters(fit.GetParameters());
  blind->HoldOutOn();
  blind->Update();
  report["heldOutError"] = ErrorAtVoxels(blind->GetOutput()->GetArrays(), ct, true);
  return report;
}

void
RunFit(const FitOptions & options, Session & session)
{
  const std::string conflict = FindConflict(options.parameters);
  if (!conflict.empty())
  {
    throw UsageError(conflict);
  }
  VerifyOutputs({ { options.output, { ".vtu" } }, { options.report, {} } });
  const auto ct = ReadChosenCT(options.ct, options.series, session);
  auto       fit = Fit::New();
  fit->SetImage(ct);
  fit->SetMesh(ReadDensityMesh(options.mesh));
  if (!options.weights.empty())
  {
    fit->SetWeights(ReadCT(options.weights));
  }
  fit->SetParameters(options.parameters);
  session.Watch(fit, "density fit");
  fit->Update();
  for (const std::string & doubt : fit->GetDoubts())
  {
    session.WarnAlways(doubt);
  }
  if (fit->GetReport().unsupported > 0)
  {
    session.Warn(std::to_string(fit->GetReport().unsupported) +
                 " tetrahedra lie where all weights are 0; they were fitted as if there were no weights.");
  }
  WriteDensityMesh(fit->GetOutput(), options.output, options.storage);
  if (!options.report.empty())
  {
    AtomicFile file(options.report);
    file.Write(DescribeFit(*fit, *ct).dump(1) + "\n");
    file.Commit();
  }
}
} // namespace

void
AddFitCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<FitOptions>();
  auto * command = app.add_subcommand("fit", "Fit a Bernstein polynomial to the CT in every tetrahedron");
  command->add_option("ct", options->ct, "CT: an image file, or the folder of a DICOM series")->required();
  AddSeriesOption(command, options->series);
  command->add_option("mesh", options->mesh, "Mesh (.vtu); a density it holds is replaced")->required();
  AddParameterOptions(command, options->parameters);
  command->get_option("--max-error")
    ->excludes(command->get_option("--continuous"))
    ->excludes(command->get_option("--continuous-gradient"));
  AddStorageOptions(command, options->storage);
  command->add_option("--weights", options->weights, "Image of weights, 0 or more: how much each place counts");
  command->add_option("--report", options->report, "Figures of the fit, with the error at held-out voxels (.json)");
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunFit(*options, session); }; });
}
} // namespace bone
