/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneBuildPlan.h"
#include "boneContourIO.h"
#include "boneImageIO.h"
#include "boneMeshIO.h"
#include "boneMeshQualityFilter.h"
#include "boneTetraSmoothingFilter.h"

namespace bone
{
namespace
{
struct SmoothOptions
{
  std::string              input;
  std::string              method{ "quality" };
  std::string              contours;
  LabelOptions             labels;
  BuildPlanParameters      plan;
  MeshQualityParameters    quality;
  TetraSmoothingParameters smoothing;
  bool                     distance{ false };   ///< given
  bool                     iterations{ false }; ///< given
  std::string              output;
};

using MeshType = DensityMesh<double>;
using FilterType = MeshToMeshFilter<MeshType>;

/** The whole chain of \ref MeshQualityFilter, as `bonetk build` has it. */
FilterType::Pointer
MakeQuality(const SmoothOptions & options, Session & session)
{
  auto quality = MeshQualityFilter<MeshType>::New();
  quality->SetParameters(options.quality);
  if (!options.contours.empty())
  {
    quality->SetContours(ReadContours(options.contours));
  }
  if (!options.labels.file.empty())
  {
    const LabelledBone bone = ReadOneBoneLabels(options.labels, nullptr, session);
    quality->SetLabelImage(bone.labels);
    quality->SetLabel(bone.label);
    if (!options.distance)
    {
      quality->SetDistanceBound(FindDistanceBound(*bone.labels, options.plan));
    }
  }
  return quality.GetPointer();
}

/** Moves of points alone. */
FilterType::Pointer
MakeSmoothing(const SmoothOptions & options)
{
  auto smoothing = TetraSmoothingFilter<MeshType>::New();
  smoothing->SetParameters(options.smoothing);
  smoothing->SetMethod(ParseChoice<SmoothingMethod>(options.method));
  smoothing->SetDistanceBound(options.quality.distanceBound);
  smoothing->SetFairingIterations(options.quality.fairingIterations);
  if (options.iterations)
  {
    smoothing->SetIterations(options.quality.iterations);
  }
  return smoothing.GetPointer();
}

void
RunSmooth(const SmoothOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".vtu" } } });
  const FilterType::Pointer filter =
    options.method == "quality" ? MakeQuality(options, session) : MakeSmoothing(options);
  const MeshType::Pointer mesh = ReadDensityMesh(options.input);
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
  auto   options = std::make_shared<SmoothOptions>();
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
  options->labels.AddTo(command, "Label map of the bone, to whose voxels quality fits the surface next to contours");
  command->get_option("--label")->needs("--labels");
  AddParameterOptions(command, options->quality);
  AddParameterOptions(command, options->smoothing, { "weight", "angleFloor" });
  AddAxisOption(command, options->plan.axis);
  command->get_option("--iterations")->description("Passes of smoothing; default 4 (at its start) in quality, else 10");
  command->get_option("--distance")
    ->description("How far a surface may go, in mm; default 0.3, with --labels half a pixel of it at most");
  command->add_option("-o,--output", options->output, "Mesh to write (.vtu)")->required();
  command->callback([options, command, &action] {
    options->distance = command->count("--distance") > 0;
    options->iterations = command->count("--iterations") > 0;
    for (const char * of : { "--contours",
                             "--labels",
                             "--stiffness",
                             "--rounds",
                             "--target-angle",
                             "--gradation",
                             "--optimization-passes",
                             "--sliver-factor" })
    {
      if (options->method != "quality" && command->count(of) > 0)
      {
        throw CLI::ValidationError(of, "goes with --method quality only");
      }
    }
    action = [options](Session & session) { RunSmooth(*options, session); };
  });
}
} // namespace bone
