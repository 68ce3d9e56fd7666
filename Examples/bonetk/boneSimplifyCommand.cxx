/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"

#include "boneHierarchyIO.h"
#include "boneMeshIO.h"
#include "boneTetraCollapseFilter.h"

#include <algorithm>

namespace bone
{
namespace
{
struct Options
{
  std::string         mesh;
  std::vector<IdType> tetrahedra;
  std::vector<double> errors;
  std::string         prefix;
};

void
Run(const Options & options, Session & session)
{
  if (options.tetrahedra.empty() && options.errors.empty())
  {
    throw UsageError("--tetrahedra or --max-density-error is required");
  }
  if (!std::is_sorted(options.tetrahedra.rbegin(), options.tetrahedra.rend()))
  {
    throw UsageError("--tetrahedra must not ascend: each level is coarser than the one before");
  }
  if (!std::is_sorted(options.errors.begin(), options.errors.end()))
  {
    throw UsageError("--max-density-error must not descend: each level is coarser than the one before");
  }
  auto collapse = TetraCollapseFilter<DensityMesh<double>>::New();
  collapse->SetInput(ReadDensityMesh(options.mesh));
  collapse->SetLevels(options.tetrahedra);
  collapse->SetMaximumDensityErrors(options.errors);
  session.Watch(collapse, "simplification");
  collapse->Update();
  WriteHierarchy(collapse->GetOutput(), options.prefix);
}
} // namespace

void
AddSimplifyCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<Options>();
  auto * command = app.add_subcommand("simplify", "Simplify a density mesh into a hierarchy of coarser levels");
  command->add_option("mesh", options->mesh, "Density mesh (.vtu)")->required();
  command->add_option("--tetrahedra", options->tetrahedra, "Tetrahedra of each coarser level, in order")
    ->check(Between(1, 1e9));
  command
    ->add_option("--max-density-error",
                 options->errors,
                 "Bound on the root mean square density error of each coarser level, in density units")
    ->check(NotNegative());
  command->add_option("-o,--output", options->prefix, "Prefix of PREFIX_L1.vtu, ... and PREFIX.hierarchy.json")
    ->required();
  command->callback([options, &action] { action = [options](Session & session) { Run(*options, session); }; });
}
} // namespace bone
