/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneBuildPlan.h"
#include "boneHierarchyIO.h"
#include "boneMeshIO.h"
#include "boneTetraCollapseFilter.h"

#include <algorithm>

namespace bone
{
namespace
{
struct SimplifyOptions
{
  std::string             mesh;
  TetraCollapseParameters parameters;
  BuildPlanParameters     plan;            ///< its levels, where nothing else says how far to go
  bool                    levels{ false }; ///< given
  MeshStorageParameters   storage;
  std::string             prefix;
};

/** Throws a UsageError where a level is finer than the one before. */
void
Verify(const TetraCollapseParameters & parameters)
{
  if (!std::is_sorted(parameters.levels.rbegin(), parameters.levels.rend()))
  {
    throw UsageError("--tetrahedra must not ascend: each level is coarser than the one before");
  }
  if (!std::is_sorted(parameters.maximumDensityErrors.begin(), parameters.maximumDensityErrors.end()))
  {
    throw UsageError("--max-density-error must not descend: each level is coarser than the one before");
  }
  if (!std::is_sorted(parameters.maximumCellErrors.begin(), parameters.maximumCellErrors.end()))
  {
    throw UsageError("--max-cell-error must not descend: each level is coarser than the one before");
  }
  if (!std::is_sorted(parameters.maximumSurfaceDistances.begin(), parameters.maximumSurfaceDistances.end()))
  {
    throw UsageError("--max-surface-distance must not descend: each level is coarser than the one before");
  }
}

void
RunSimplify(const SimplifyOptions & options, Session & session)
{
  TetraCollapseParameters parameters = options.parameters;
  Verify(parameters);
  VerifyOutputs({ { options.prefix + ".hierarchy.json", {} } });
  session.Expect({ { "reading", 0.2 }, { "simplification", 3.0 }, { "writing", 0.3 } });
  const auto mesh = [&] {
    const auto stage = session.BeginStage("reading");
    return ReadDensityMesh(options.mesh);
  }();
  if (options.levels || (parameters.levels.empty() && parameters.maximumDensityErrors.empty() &&
                         parameters.maximumCellErrors.empty() && parameters.maximumSurfaceDistances.empty()))
  {
    try
    {
      parameters.levels = CountTetrahedraOfLevels(options.plan.levels, mesh->GetNumberOfTetrahedra());
    }
    catch (const std::invalid_argument & error)
    {
      throw UsageError(std::string("--") + error.what());
    }
  }
  auto collapse = TetraCollapseFilter<DensityMesh<double>>::New();
  collapse->SetInput(mesh);
  collapse->SetParameters(parameters);
  session.Watch(collapse, "simplification");
  collapse->Update();
  const auto stage = session.BeginStage("writing");
  WriteHierarchy(collapse->GetOutput(), options.prefix, options.storage);
}
} // namespace

void
AddSimplifyCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<SimplifyOptions>();
  auto * command = app.add_subcommand("simplify", "Simplify a density mesh into a hierarchy of coarser levels");
  command->add_option("mesh", options->mesh, "Density mesh (.vtu)")->required();
  AddParameterOptions(command, options->parameters);
  AddParameterOptions(command, options->plan, { "levels" });
  AddStorageOptions(command, options->storage);
  command->get_option("--improve-angles")->excludes("--max-surface-distance")->excludes("--max-cell-error");
  command->get_option("--levels")->excludes("--tetrahedra");
  command->add_option("-o,--output", options->prefix, "Prefix of PREFIX_L1.vtu, ... and PREFIX.hierarchy.json")
    ->required();
  command->callback([options, command, &action] {
    options->levels = command->count("--levels") > 0;
    if (command->count("--min-angle") > 0 && command->count("--min-cortical-angle") == 0)
    {
      options->parameters.minimumCorticalDihedralAngle = 0.5 * options->parameters.minimumDihedralAngle;
    }
    action = [options](Session & session) { RunSimplify(*options, session); };
  });
}
} // namespace bone
