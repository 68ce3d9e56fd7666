/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneRadiographPicture.h"

#include "boneDensityEvaluation.h"
#include "boneFileName.h"
#include "boneDRRImageFilter.h"
#include "boneGeometryIO.h"
#include "boneIntensityImageFilter.h"
#include "boneMeshIO.h"
#include "boneNoiseImageFilter.h"
#include "boneViewPresets.h"
#include "boneVoxelDRRImageFilter.h"

#include <itkImageRegionConstIteratorWithIndex.h>

#include <map>
#include <sstream>

namespace bone
{
namespace
{
struct DrrOptions
{
  std::string             input;
  std::string             series;
  std::string             geometry;
  std::vector<ViewPreset> presets;
  std::vector<double>     carm; ///< primary and secondary angle of each view
  CArmView                distances;
  int                     pixels{ 512 };
  bool                    framed{ false }; ///< distances or pixels were given
  std::string             mask;
  bool                    raw{ false };
  bool                    attenuation{ false };
  bool                    bilinear{ false };
  int                     region{ 0 };
  double                  intensity{ 0 };
  int                     noise{ 0 };
  PictureOptions          picture;
  bool                    pictured{ false }; ///< one of them was given
  std::string             output;
  std::string             savedGeometry;
  std::string             convention;
};

using Radiograph = CTImage;

/** What is projected. */
struct DrrInput
{
  RadiographSource<Radiograph>::Pointer source;
  ViewBox                               box;  ///< that presets frame
  std::string                           unit; ///< of the density
};

ViewBox
EmptyBox()
{
  return { Vector3::Constant(std::numeric_limits<double>::max()),
           Vector3::Constant(-std::numeric_limits<double>::max()) };
}

void
Include(const Vector3 & point, ViewBox & box)
{
  box.lower = box.lower.cwiseMin(point);
  box.upper = box.upper.cwiseMax(point);
}

/** The box of an image's region, with the whole of its voxels. */
ViewBox
BoxOfRegion(const itk::ImageBase<3> & image, const itk::ImageRegion<3> & region)
{
  ViewBox box = EmptyBox();
  for (unsigned int corner = 0; corner < 8; ++corner)
  {
    itk::ContinuousIndex<double, 3> index;
    for (unsigned int k = 0; k < 3; ++k)
    {
      index[k] = (corner >> k & 1) != 0 ? region.GetUpperIndex()[k] + 0.5 : region.GetIndex()[k] - 0.5;
    }
    const auto point = image.TransformContinuousIndexToPhysicalPoint<double>(index);
    Include(Vector3(point[0], point[1], point[2]), box);
  }
  return box;
}

ViewBox
BoxOfMask(const LabelImage & mask)
{
  const auto whole = mask.GetBufferedRegion();
  auto       lower = whole.GetUpperIndex(), upper = whole.GetIndex();
  for (itk::ImageRegionConstIteratorWithIndex<LabelImage> it(&mask, whole); !it.IsAtEnd(); ++it)
  {
    for (unsigned int k = 0; k < 3 && it.Get() != 0; ++k)
    {
      lower[k] = std::min(lower[k], it.GetIndex()[k]);
      upper[k] = std::max(upper[k], it.GetIndex()[k]);
    }
  }
  itk::ImageRegion<3> region;
  region.SetIndex(lower);
  region.SetUpperIndex(upper);
  return BoxOfRegion(mask, lower[0] > upper[0] ? whole : region); // of an empty mask the filter says so
}

DrrInput
ReadMesh(const DrrOptions & options)
{
  if (!options.mask.empty() || options.raw)
  {
    throw UsageError(std::string(options.raw ? "--raw" : "--mask") + " goes with a voxel image only");
  }
  const auto mesh = ReadDensityMesh(options.input);
  auto       filter = DRRImageFilter<DensityMesh<double>, Radiograph>::New();
  filter->SetInput(mesh);
  if (options.region > 0)
  {
    filter->SetMinimumRegion(options.region);
    filter->SetMaximumRegion(options.region);
  }
  DrrInput input{ filter.GetPointer(), EmptyBox(), DensityUnitName(mesh->GetArrays().quantity) };
  for (const Vector3 & point : mesh->GetArrays().points)
  {
    Include(point, input.box);
  }
  return input;
}

DrrInput
ReadVoxels(const DrrOptions & options, Session & session)
{
  if (options.region > 0)
  {
    throw UsageError("--region goes with a density mesh only");
  }
  auto                   filter = VoxelDRRImageFilter<CTImage, Radiograph>::New();
  const CTImage::Pointer ct = ReadChosenCT(options.input, options.series, session);
  filter->SetInput(ct);
  DrrInput input{ filter.GetPointer(), BoxOfRegion(*ct, ct->GetLargestPossibleRegion()), "HU" };
  if (!options.mask.empty())
  {
    const auto mask = ReadLabelsOnGrid(options.mask, ct, session);
    filter->SetMask(mask);
    input.box = BoxOfMask(*mask);
  }
  else if (!options.raw && !options.attenuation && !options.bilinear)
  {
    filter->AboveAirOn();
    session.Print("a voxel counts max(0, HU + 1000), what it has above air; with --raw its HU\n");
  }
  return input;
}

/** The views, but where they are framed around what is projected only their number is known yet. */
std::vector<XRayGeometry::Pointer>
ReadViews(const DrrOptions & options)
{
  if (!options.geometry.empty())
  {
    return ReadGeometry(options.geometry);
  }
  std::vector<XRayGeometry::Pointer> views(options.presets.size() + options.carm.size() / 2);
  std::generate(views.begin(), views.end(), [] { return XRayGeometry::New(); });
  return views;
}

void
FrameViews(const DrrOptions & options, ViewBox box, const std::vector<XRayGeometry::Pointer> & views)
{
  constexpr double margin = 5.0; // mm
  box.lower.array() -= margin;
  box.upper.array() += margin;
  try
  {
    for (std::size_t i = 0; i < options.presets.size(); ++i)
    {
      views[i]->SetView(FramePreset(options.presets[i], options.distances, box, options.pixels));
    }
    for (std::size_t i = 0; i < options.carm.size() / 2; ++i)
    {
      CArmView arm = options.distances;
      arm.primary = options.carm[2 * i];
      arm.secondary = options.carm[2 * i + 1];
      views[i]->SetView(FrameCArm(arm, box, options.pixels));
    }
  }
  catch (const itk::ExceptionObject & error)
  {
    throw UsageError(ErrorLine(error) + " Give other --carm, --source-isocentre or --source-detector");
  }
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

bool
IsPicture(const DrrOptions & options)
{
  return HasExtension(options.output, ".png");
}

/** An image with all its values, or a picture, of which a line says what black and white are. */
void
WriteView(const DrrOptions &  options,
          const Radiograph *  image,
          const std::string & unit,
          const std::string & path,
          Session &           session)
{
  if (!IsPicture(options))
  {
    WriteImage(image, path);
    return;
  }
  const GreyScale scale = options.intensity > 0 ? ScaleOfIntensities(image, options.intensity, options.picture)
                                                : ScaleOfIntegrals(image, options.picture);
  WriteRadiographPicture(image, scale, options.picture.bits, path);
  const std::string  values = options.intensity > 0                     ? " photons"
                              : options.attenuation || options.bilinear ? " (attenuation, no unit)"
                                                                        : ' ' + unit + " mm";
  std::ostringstream line;
  line << path << ": black " << scale.black << ", white " << scale.white << values << '\n';
  session.Print(line.str());
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

/** Throws UsageError where options do not go together. */
void
Verify(const DrrOptions & options)
{
  const int ways =
    (options.geometry.empty() ? 0 : 1) + (options.presets.empty() ? 0 : 1) + (options.carm.empty() ? 0 : 1);
  if (ways != 1)
  {
    throw UsageError(std::string(ways == 0 ? "how it is seen is required" : "it can be seen in one way only") +
                     ": give --geometry, --view or --carm");
  }
  if (options.carm.size() % 2 != 0)
  {
    throw UsageError("--carm needs a primary and a secondary angle for each view");
  }
  if (options.framed && !options.geometry.empty())
  {
    throw UsageError(
      "--size, --source-isocentre and --source-detector go with --view or --carm: a --geometry has its own");
  }
  if (options.intensity > 0 && !options.attenuation && !options.bilinear)
  {
    throw UsageError("--intensity needs attenuation: give --attenuation or --bilinear too");
  }
  if (options.noise > 0 && !(options.intensity > 0))
  {
    throw UsageError("--noise needs --intensity, the photons a pixel");
  }
  if (options.pictured && !IsPicture(options))
  {
    throw UsageError("--bits, --window and --invert go with a picture: let -o end in .png");
  }
  const std::vector<double> & window = options.picture.window;
  if (!window.empty() && !(window[0] < window[1]))
  {
    throw UsageError("--window needs a lower and a higher value, in that order");
  }
}

/** The same of the pixels of a picture, which are square. */
void
VerifySquare(const DrrOptions & options, const std::vector<XRayGeometry::Pointer> & views)
{
  constexpr double tolerance = 1e-6;
  for (const auto & view : views)
  {
    const Vector2 spacing = view->GetView().spacing;
    if (IsPicture(options) && std::abs(spacing.x() - spacing.y()) > tolerance * spacing.x())
    {
      std::ostringstream text;
      text << options.geometry << " has pixels of " << spacing.x() << " x " << spacing.y()
           << " mm, but those of a .png are square: write another format";
      throw UsageError(text.str());
    }
  }
}

void
RunDrr(const DrrOptions & options, Session & session)
{
  Verify(options);
  const auto views = ReadViews(options);
  VerifySquare(options, views);
  std::vector<OutputFile>  files{ { options.savedGeometry, {} } };
  std::vector<std::string> extensions = ImageExtensions();
  extensions.push_back(".png");
  for (std::size_t i = 0; i < views.size(); ++i)
  {
    files.push_back({ ViewPath(options.output, i, views.size()), extensions });
  }
  VerifyOutputs(files);
  session.Expect({ { "reading", 1.0 }, { "drr", 2.0 }, { "writing", 0.5 } });
  const DrrInput input = [&] {
    const auto stage = session.BeginStage("reading");
    return HasExtension(options.input, ".vtu") ? ReadMesh(options) : ReadVoxels(options, session);
  }();
  FrameViews(options, input.box, views);
  input.source->SetHUToAttenuation(options.bilinear      ? HUToAttenuation::Bilinear
                                   : options.attenuation ? HUToAttenuation::WaterScaled
                                                         : HUToAttenuation::None);
  session.Watch(input.source, "drr");
  for (unsigned int i = 0; i < views.size(); ++i)
  {
    input.source->SetGeometry(i, views[i]);
  }
  input.source->Update();
  const auto stage = session.BeginStage("writing");
  for (unsigned int i = 0; i < views.size(); ++i)
  {
    const Radiograph::Pointer image = Detect(options, input.source->GetOutput(i), i);
    WriteView(options, image, input.unit, ViewPath(options.output, i, views.size()), session);
  }
  if (!options.savedGeometry.empty())
  {
    SaveGeometry(options, views, session);
  }
}

/** The number of the preset that has the name. */
std::string
ToPreset(std::string & text)
{
  static const std::map<std::string, ViewPreset> presets{ { "ap", ViewPreset::AP },
                                                          { "pa", ViewPreset::PA },
                                                          { "lateral", ViewPreset::LeftLateral },
                                                          { "left-lateral", ViewPreset::LeftLateral },
                                                          { "right-lateral", ViewPreset::RightLateral } };
  const auto                                     found = presets.find(CLI::detail::to_lower(text));
  if (found == presets.end())
  {
    return text + " is no view: ap, pa, left-lateral (or lateral) and right-lateral are";
  }
  text = std::to_string(static_cast<int>(found->second));
  return "";
}

std::string
CheckBits(std::string & text)
{
  return text == "8" || text == "16" ? "" : text + " is not 8 or 16";
}

void
AddViewOptions(CLI::App * command, DrrOptions & options)
{
  command->add_option("--geometry", options.geometry, "Views (.json); several write NAME_V1, NAME_V2, ...");
  command
    ->add_option("--view",
                 options.presets,
                 "Views framed around the model, mask or CT: ap, pa, left-lateral (or lateral; detector at the "
                 "patient's left), right-lateral")
    ->transform(CLI::Validator(ToPreset, ""))
    ->type_name("ap|pa|left-lateral|lateral|right-lateral");
  command->add_option("--carm",
                      options.carm,
                      "The same for a C-arm: primary (LAO positive) and secondary angle (CRA positive) of each view, "
                      "degrees");
  command->add_option("--size", options.pixels, "Pixels of the longer side, with --view or --carm; default 512")
    ->check(CLI::Range(1, 16384).description(""));
  command
    ->add_option("--source-isocentre",
                 options.distances.sourceToIsocenter,
                 "Source to isocentre, the middle of what is framed, mm; default 700")
    ->check(Length());
  command->add_option("--source-detector", options.distances.sourceToDetector, "Source to detector, mm; default 1000")
    ->check(Length());
}

void
AddPictureOptions(CLI::App * command, PictureOptions & picture)
{
  command->add_option("--bits", picture.bits, "Bits a pixel of a .png, 8 (default) or 16")
    ->check(CLI::Validator(CheckBits, ""));
  command
    ->add_option("--window",
                 picture.window,
                 "Values at black and white of a .png; default: 0 and the 99.5th percentile of pixels that are not 0 "
                 "(of intensities, which are white where low: 0.5th percentile and --intensity)")
    ->expected(2);
  command->add_flag("--invert", picture.inverted, "Bones dark in a .png; default: what attenuates more is brighter");
}
} // namespace

void
AddDrrCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<DrrOptions>();
  auto * command = app.add_subcommand("drr",
                                      "Digitally reconstructed radiograph of a density mesh or a voxel image. A CT's "
                                      "voxels count max(0, HU + 1000), what they have above air; with --mask or --raw "
                                      "their HU");
  command->add_option("input", options->input, "Density mesh (.vtu), or a CT")->required();
  AddSeriesOption(command, options->series);
  AddViewOptions(command, *options);
  command->add_option("--mask", options->mask, "Label map: only voxels that are not 0 count, with their HU");
  auto * attenuation =
    command->add_flag("--attenuation", options->attenuation, "Turn HU into attenuation of water at 60 keV first");
  auto * bilinear = command->add_flag(
    "--bilinear", options->bilinear, "Turn HU into attenuation, bone along a line of its own (CT only)");
  command->add_flag("--raw", options->raw, "Integrate a CT's HU as they are: air counts -1000")
    ->excludes(attenuation)
    ->excludes(bilinear);
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
  AddPictureOptions(command, options->picture);
  command->add_option("--save-geometry", options->savedGeometry, "Also write the views, as --convention says");
  command->add_option("--convention", options->convention, "view (default), matrix, plastimatch (.json) or rtk (.xml)")
    ->check(CLI::IsMember({ "view", "matrix", "plastimatch", "rtk" }).description(""))
    ->type_name("view|matrix|plastimatch|rtk")
    ->needs("--save-geometry");
  command
    ->add_option(
      "-o,--output", options->output, "Radiograph to write (.mha, .nii.gz, .nrrd, ...), or a picture of it (.png)")
    ->required();
  command->callback([options, command, &action] {
    options->framed =
      command->count("--size") + command->count("--source-isocentre") + command->count("--source-detector") > 0;
    options->pictured = command->count("--bits") + command->count("--window") + command->count("--invert") > 0;
    action = [options](Session & session) { RunDrr(*options, session); };
  });
}
} // namespace bone
