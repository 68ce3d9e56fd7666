/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneOptions.h"

#include "boneContourIO.h"
#include "boneImageIO.h"
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
  std::string method{ "quality" };
  std::string contours;
  std::string labels;
  int         label{ 0 };
  int         iterations{ 0 };
  double      distance{ 0.3 };
  double      stiffness{ -1.0 };
  std::string output;
};

using MeshType = DensityMesh<double>;
using FilterType = MeshToMeshFilter<MeshType>;

/** The whole chain of \ref MeshQualityFilter, as `bonetk build` has it. */
FilterType::Pointer
MakeQuality(const Options & options)
{
  auto quality = MeshQualityFilter<MeshType>::New();
  quality->SetDistanceBound(options.distance);
  if (options.iterations > 0)
  {
    quality->SetIterations(options.iterations);
  }
  if (options.stiffness >= 0)
  {
    quality->SetStiffness(options.stiffness);
  }
  if (!options.contours.empty())
  {
    quality->SetContours(ReadContours(options.contours));
  }
  if (!options.labels.empty())
  {
    quality->SetLabelImage(ReadLabels(options.labels));
    quality->SetLabel(static_cast<short>(options.label));
  }
  return quality.GetPointer();
}

/** Moves of points alone. */
FilterType::Pointer
MakeSmoothing(const Options & options)
{
  static const std::map<std::string, SmoothingMethod> methods = { { "laplacian", SmoothingMethod::Laplacian },
                                                                  { "smart", SmoothingMethod::Smart },
                                                                  { "enhanced", SmoothingMethod::Enhanced } };
  if (!options.contours.empty() || !options.labels.empty() || options.stiffness >= 0)
  {
    throw UsageError("--contours, --labels and --stiffness go with --method quality only");
  }
  auto smoothing = TetraSmoothingFilter<MeshType>::New();
  smoothing->SetMethod(methods.at(options.method));
  smoothing->SetDistanceBound(options.distance);
  if (options.iterations > 0)
  {
    smoothing->SetIterations(options.iterations);
  }
  return smoothing.GetPointer();
}

void
Run(const Options & options, Session & session)
{
  VerifyExtension(options.output, { ".vtu" });
  const FilterType::Pointer filter = options.method == "quality" ? MakeQuality(options) : MakeSmoothing(options);
  const MeshType::Pointer   mesh = ReadDensityMesh(options.input);
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
  auto * command = app.add_subcommand("smooth", "Smooth a layered tetrahedral mesh and mend its worst tetrahedra");
  command->add_option("mesh", options->input, "Mesh (.vtu)")->required();
  command
    ->add_option(
      "--method",
      options->method,
      "quality: all that build does; the others move points and leave tetrahedra as they are: enhanced keeps "
      "the shape, smart and laplacian shrink it, laplacian may invert; default quality")
    ->check(CLI::IsMember({ "quality", "enhanced", "smart", "laplacian" }).description(""))
    ->type_name("quality|enhanced|smart|laplacian");
  command->add_option(
    "--contours", options->contours, "Contours (.vtp) of the bone, to which quality fits the surfaces");
  auto * labels = command->add_option(
    "--labels", options->labels, "Label map of the bone, to whose voxels quality fits the surface next to contours");
  command->add_option("--label", options->label, "The bone's value in the label map; default: every value but 0")
    ->check(Between(-32768, 32767))
    ->needs(labels);
  command->add_option("--distance", options->distance, "How far a surface may go, mm (quality, enhanced); default 0.3")
    ->check(NotNegative());
  command->add_option("--stiffness", options->stiffness, "Resistance of surfaces to bending (quality); default 0.08")
    ->check(NotNegative());
  command
    ->add_option(
      "--iterations", options->iterations, "Passes of smoothing; default 4 (at its start) in quality, else 10")
    ->check(Between(1, 10000));
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu)")->required();
  command->callback([options, &action] { action = [options](Session & session) { Run(*options, session); }; });
}
} // namespace bone
