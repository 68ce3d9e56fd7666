/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"

#include "boneBernstein.h"
#include "boneDensityFitFilter.h"
#include "boneMeshIO.h"

namespace bone
{
namespace
{
struct Options
{
  std::string ct;
  std::string mesh;
  int         degree{ 3 };
  bool        continuous{ false };
  std::string output;
};

void
Run(const Options & options, Session & session)
{
  VerifyExtension(options.output, { ".vtu" });
  auto fit = DensityFitFilter<CTImage, DensityMesh<double>>::New();
  fit->SetImage(ReadCT(options.ct));
  fit->SetMesh(ReadDensityMesh(options.mesh));
  fit->SetDegree(options.degree);
  fit->SetContinuous(options.continuous);
  session.Watch(fit, "density fit");
  fit->Update();
  WriteDensityMesh(fit->GetOutput(), options.output);
}
} // namespace

void
AddFitCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<Options>();
  auto * command = app.add_subcommand("fit", "Fit a Bernstein polynomial to the CT in every tetrahedron");
  command->add_option("ct", options->ct, "CT: an image file, or the folder of a DICOM series")->required();
  command->add_option("mesh", options->mesh, "Mesh (.vtu); a density it holds is replaced")->required();
  command->add_option("--degree", options->degree, "Degree of the polynomials, 0 to 8")
    ->required()
    ->check(CLI::Range(0, MaximumBernsteinDegree).description(""));
  command->add_flag("--continuous", options->continuous, "One continuous density within each region");
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu)")->required();
  command->callback([options, &action] { action = [options](Session & session) { Run(*options, session); }; });
}
} // namespace bone
