/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"

#include "boneFileName.h"
#include "boneDRRImageFilter.h"
#include "boneGeometryIO.h"
#include "boneIntensityImageFilter.h"
#include "boneMeshIO.h"
#include "boneNoiseImageFilter.h"
#include "boneVoxelDRRImageFilter.h"

#include <map>
#include <sstream>

namespace bone
{
namespace
{
struct DrrOptions
{
  std::string input;
  std::string series;
  std::string geometry;
  std::string mask;
  bool        attenuation{ false };
  bool        bilinear{ false };
  int         region{ 0 };
  double      intensity{ 0 };
  int         noise{ 0 };
  std::string output;
  std::string savedGeometry;
  std::string convention;
};

using Radiograph = CTImage;

itk::SmartPointer<RadiographSource<Radiograph>>
MakeSource(const DrrOptions & options, Session & session)
{
  if (HasExtension(options.input, ".vtu"))
  {
    if (!options.mask.empty())
    {
      throw UsageError("--mask goes with a voxel image only");
    }
    auto filter = DRRImageFilter<DensityMesh<double>, Radiograph>::New();
    filter->SetInput(ReadDensityMesh(options.input));
    if (options.region > 0)
    {
      filter->SetMinimumRegion(options.region);
      filter->SetMaximumRegion(options.region);
    }
    return filter.GetPointer();
  }
  if (options.region > 0)
  {
    throw UsageError("--region goes with a density mesh only");
  }
  auto                   filter = VoxelDRRImageFilter<CTImage, Radiograph>::New();
  const CTImage::Pointer ct = ReadChosenCT(options.input, options.series, session);
  filter->SetInput(ct);
  if (!options.mask.empty())
  {
    filter->SetMask(ReadLabelsOnGrid(options.mask, ct, session));
  }
  return filter.GetPointer();
}

/** Output of view `index` of `count`: NAME.mha, or NAME_V1.mha, NAME_V2.mha, ... */
std::string
ViewPath(const std::string & path, std::size_t index, std::size_t count)
{
  if (count == 1)
  {
    return path;
  }
  const std::size_t slash = path.find_last_of('/');
  const std::size_t start = slash == std::string::npos ? 0 : slash + 1;
  const std::size_t dot = std::min(path.find('.', start + 1), path.size());
  return path.substr(0, dot) + "_V" + std::to_string(index + 1) + path.substr(dot);
}

/** The radiograph, or what a detector sees of it where an intensity was given. */
Radiograph::Pointer
Detect(const DrrOptions & options, Radiograph * integrals, std::size_t view)
{
  if (!(options.intensity > 0))
  {
    return integrals;
  }
  auto intensity = IntensityImageFilter<Radiograph>::New();
  intensity->SetInput(integrals);
  intensity->SetIncidentIntensity(options.intensity);
  auto noise = NoiseImageFilter<Radiograph>::New();
  noise->SetInput(intensity->GetOutput());
  noise->SetPhotonsPerUnit(options.noise > 0 ? 1 : 0);
  noise->SetSeed((static_cast<std::uint64_t>(view) << 32) + static_cast<std::uint64_t>(options.noise));
  noise->Update();
  return noise->GetOutput();
}

void
SaveGeometry(const DrrOptions & options, const std::vector<XRayGeometry::Pointer> & views, Session & session)
{
  if (options.convention == "rtk")
  {
    const RtkGrid      grid = WriteRtkGeometry(views, options.savedGeometry);
    std::ostringstream text;
    text << "RTK's projection image: size " << grid.size[0] << ' ' << grid.size[1] << ", spacing "
         << grid.spacing.transpose() << ", origin " << grid.origin.transpose()
         << (grid.rowsDown ? ", second direction 0 -1 0" : "") << '\n';
    session.Print(text.str());
    return;
  }
  WriteGeometry(views,
                options.savedGeometry,
                options.convention == "matrix"        ? GeometryConvention::Matrix
                : options.convention == "plastimatch" ? GeometryConvention::Plastimatch
                                                      : GeometryConvention::View);
}

void
RunDrr(const DrrOptions & options, Session & session)
{
  if (options.intensity > 0 && !options.attenuation && !options.bilinear)
  {
    throw UsageError("--intensity needs attenuation: give --attenuation or --bilinear too");
  }
  if (options.noise > 0 && !(options.intensity > 0))
  {
    throw UsageError("--noise needs --intensity, the photons a pixel");
  }
  const auto              views = ReadGeometry(options.geometry);
  std::vector<OutputFile> files{ { options.savedGeometry, {} } };
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    files.push_back({ ViewPath(options.output, i, views.size()), ImageExtensions() });
  }
  VerifyOutputs(files);
  auto source = MakeSource(options, session);
  source->SetHUToAttenuation(options.bilinear      ? HUToAttenuation::Bilinear
                             : options.attenuation ? HUToAttenuation::WaterScaled
                                                   : HUToAttenuation::None);
  session.Watch(source, "drr");
  for (unsigned int i = 0; i < views.size(); ++i)
  {
    source->SetGeometry(i, views[i]);
  }
  source->Update();
  for (unsigned int i = 0; i < views.size(); ++i)
  {
    WriteImage(Detect(options, source->GetOutput(i), i).GetPointer(), ViewPath(options.output, i, views.size()));
  }
  if (!options.savedGeometry.empty())
  {
    SaveGeometry(options, views, session);
  }
}
} // namespace

void
AddDrrCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<DrrOptions>();
  auto * command = app.add_subcommand("drr", "Digitally reconstructed radiograph of a density mesh or a voxel image");
  command->add_option("input", options->input, "Density mesh (.vtu), or a CT")->required();
  AddSeriesOption(command, options->series);
  command->add_option("--geometry", options->geometry, "Views (.json); several write NAME_V1, NAME_V2, ...")
    ->required();
  command->add_option("--mask", options->mask, "Label map: only voxels that are not 0 count");
  command->add_flag("--attenuation", options->attenuation, "Turn HU into attenuation of water at 60 keV first");
  command->add_flag(
    "--bilinear", options->bilinear, "Turn HU into attenuation, bone along a line of its own (CT only)");
  command
    ->add_option(
      "--region", options->region, "Only this region of the mesh: cortical, trabecular, cavity or its number")
    ->transform(CLI::Transformer(std::map<std::string, int>{
                                   { "cortical", 1 }, { "trabecular", 2 }, { "spongy", 2 }, { "cavity", 3 } })
                  .description(""))
    ->check(CLI::PositiveNumber.description(""));
  command
    ->add_option("--intensity",
                 options->intensity,
                 "Write what a detector sees of this many photons a pixel, not the "
                 "line integrals (with --attenuation or --bilinear)")
    ->check(Positive());
  command->add_option("--noise", options->noise, "Seed of quantum noise (with --intensity)")
    ->check(CLI::PositiveNumber.description(""));
  command->add_option("--save-geometry", options->savedGeometry, "Also write the views, as --convention says");
  command->add_option("--convention", options->convention, "view (default), matrix, plastimatch (.json) or rtk (.xml)")
    ->check(CLI::IsMember({ "view", "matrix", "plastimatch", "rtk" }).description(""))
    ->needs("--save-geometry");
  command->add_option("-o,--output", options->output, "Radiograph to write (.mha, .nii.gz, .nrrd, ...)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunDrr(*options, session); }; });
}
} // namespace bone
