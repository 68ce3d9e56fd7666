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
constexpr double Radian = 0.017453292519943295;

struct Options
{
  std::string         mesh;
  std::vector<IdType> tetrahedra;
  std::vector<double> errors;
  std::vector<double> distances;
  double              volume{ 3.0 };
  double              angle{ 3.0 };
  int                 degree{ -1 };
  std::string         prefix;
};

void
Run(const Options & options, Session & session)
{
  if (options.tetrahedra.empty() && options.errors.empty() && options.distances.empty())
  {
    throw UsageError("--tetrahedra, --max-density-error or --max-surface-distance is required");
  }
  if (!std::is_sorted(options.tetrahedra.rbegin(), options.tetrahedra.rend()))
  {
    throw UsageError("--tetrahedra must not ascend: each level is coarser than the one before");
  }
  if (!std::is_sorted(options.errors.begin(), options.errors.end()))
  {
    throw UsageError("--max-density-error must not descend: each level is coarser than the one before");
  }
  if (!std::is_sorted(options.distances.begin(), options.distances.end()))
  {
    throw UsageError("--max-surface-distance must not descend: each level is coarser than the one before");
  }
  auto collapse = TetraCollapseFilter<DensityMesh<double>>::New();
  collapse->SetInput(ReadDensityMesh(options.mesh));
  collapse->SetLevels(options.tetrahedra);
  collapse->SetMaximumDensityErrors(options.errors);
  collapse->SetMaximumSurfaceDistances(options.distances);
  collapse->SetMaximumVolumeChange(options.volume / 100.0);
  collapse->SetMinimumDihedralAngle(options.angle * Radian);
  collapse->SetMinimumCorticalDihedralAngle(0.5 * options.angle * Radian);
  collapse->SetMaximumDegree(options.degree);
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
  command
    ->add_option("--max-surface-distance",
                 options->distances,
                 "Bound on the distance of boundary and interfaces of each coarser level to the first, and back, mm")
    ->check(NotNegative());
  command
    ->add_option("--max-volume-change",
                 options->volume,
                 "Bound on the change of each region's volume, %; default 3")
    ->check(NotNegative());
  command
    ->add_option("--min-angle",
                 options->angle,
                 "No dihedral angle falls below this and what was there, degrees; half of it in the cortical layer; default 3")
    ->check(Between(0, 70));
  command
    ->add_option("--max-degree",
                 options->degree,
                 "Degree to which polynomials may be raised to keep to --max-density-error; default: not raised")
    ->check(Between(0, 8));
  command->add_option("-o,--output", options->prefix, "Prefix of PREFIX_L1.vtu, ... and PREFIX.hierarchy.json")
    ->required();
  command->callback([options, &action] { action = [options](Session & session) { Run(*options, session); }; });
}
} // namespace bone
