/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"

#include "boneMeshIO.h"
#include "boneMeshQualityFilter.h"
#include "boneTetraSmoothingFilter.h"

#include <map>

namespace bone
{
namespace
{
struct Options
{
  std::string input;
  std::string method{ "enhanced" };
  int         iterations{ 10 };
  double      distance{ 0.3 };
  bool        swap{ false };
  std::string output;
};

void
Run(const Options & options, Session & session)
{
  using MeshType = DensityMesh<double>;
  static const std::map<std::string, SmoothingMethod> methods = { { "laplacian", SmoothingMethod::Laplacian },
                                                                  { "smart", SmoothingMethod::Smart },
                                                                  { "enhanced", SmoothingMethod::Enhanced } };
  VerifyExtension(options.output, { ".vtu" });
  if (options.swap && options.method != "enhanced")
  {
    throw UsageError("--swap goes with --method enhanced only");
  }
  const MeshType::Pointer                       mesh = ReadDensityMesh(options.input);
  itk::SmartPointer<MeshToMeshFilter<MeshType>> filter;
  if (options.swap)
  {
    auto quality = MeshQualityFilter<MeshType>::New();
    quality->SetIterations(options.iterations);
    quality->SetDistanceBound(options.distance);
    filter = quality;
  }
  else
  {
    auto smoothing = TetraSmoothingFilter<MeshType>::New();
    smoothing->SetMethod(methods.at(options.method));
    smoothing->SetIterations(options.iterations);
    smoothing->SetDistanceBound(options.distance);
    filter = smoothing;
  }
  if (mesh->GetCells().HasDensity())
  {
    session.Warn("the density of " + options.input + " does not hold for moved tetrahedra and is left out: fit again");
  }
  filter->SetInput(mesh);
  session.Watch(filter, "smooth");
  filter->Update();
  WriteDensityMesh(filter->GetOutput(), options.output);
}
} // namespace

void
AddSmoothCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<Options>();
  auto * command = app.add_subcommand("smooth", "Smooth a layered tetrahedral mesh");
  command->add_option("mesh", options->input, "Mesh (.vtu)")->required();
  command->add_option("--method", options->method, "Smoothing method; default enhanced")
    ->check(CLI::IsMember({ "laplacian", "smart", "enhanced" }).description(""))
    ->type_name("laplacian|smart|enhanced");
  command->add_option("--iterations", options->iterations, "Passes over all points; default 10")
    ->check(Between(1, 10000));
  command->add_option("--distance", options->distance, "How far enhanced may move a surface, mm; default 0.3")
    ->check(NotNegative());
  command->add_flag("--swap", options->swap, "Swap faces and edges and optimise the worst tetrahedra too");
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu)")->required();
  command->callback([options, &action] { action = [options](Session & session) { Run(*options, session); }; });
}
} // namespace bone
