/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneInputOptions.h"
#include "boneOptions.h"
#include "boneParameterOptions.h"

#include "boneAtomicFile.h"
#include "boneDensityEvaluation.h"
#include "boneDensityImageFilter.h"
#include "boneLinearSampler.h"
#include "boneMeshIO.h"

#include <cmath>
#include <limits>
#include <sstream>

namespace bone
{
namespace
{
struct VoxelsOptions
{
  std::string            mesh;
  std::string            like;
  double                 spacing{ 1.0 };
  DensityImageParameters image;
  std::string            output;
};

void
RunVoxels(const VoxelsOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, ImageExtensions() } });
  const auto mesh = ReadDensityMesh(options.mesh);
  auto       filter = DensityImageFilter<DensityMesh<double>, CTImage>::New();
  filter->SetInput(mesh);
  filter->SetParameters(options.image);
  if (!options.like.empty())
  {
    filter->SetReferenceImage(ReadCT(options.like));
  }
  else
  {
    // A grid along the axes that holds the body.
    Vector3 lower = Vector3::Constant(std::numeric_limits<double>::max()), upper = -lower;
    for (const Vector3 & p : mesh->GetArrays().points)
    {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
    CTImage::PointType   origin;
    CTImage::SizeType    size;
    CTImage::SpacingType spacing;
    spacing.Fill(options.spacing);
    for (unsigned int axis = 0; axis < 3; ++axis)
    {
      origin[axis] = lower[axis] - options.spacing;
      size[axis] = static_cast<itk::SizeValueType>(std::ceil((upper[axis] - origin[axis]) / options.spacing)) + 2;
    }
    const double voxels = static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]);
    if (!(voxels <= LargestNumberOfVoxels))
    {
      std::ostringstream message;
      message << "--spacing " << options.spacing << " gives " << voxels << " voxels, where " << LargestNumberOfVoxels
              << " are the most; choose a larger one";
      throw UsageError(message.str());
    }
    filter->SetOrigin(origin);
    filter->SetSize(size);
    filter->SetSpacing(spacing);
  }
  session.Watch(filter, "voxels");
  filter->Update();
  WriteImage(filter->GetOutput(), options.output);
}

struct ProfileOptions
{
  std::string         mesh;
  std::vector<double> from;
  std::vector<double> to;
  std::size_t         points{ 201 };
  std::string         ct;
  std::string         series;
  std::string         output;
};

void
RunProfile(const ProfileOptions & options, Session & session)
{
  VerifyOutputs({ { options.output, { ".csv" } } });
  const MeshArrays mesh = ReadMeshArrays(options.mesh);
  const auto       profile =
    DensityProfile(mesh, TetraLocator(mesh), Vector3(options.from.data()), Vector3(options.to.data()), options.points);
  CTImage::Pointer ct;
  VoxelGrid        grid;
  if (!options.ct.empty())
  {
    ct = ReadChosenCT(options.ct, options.series, session);
    grid = MakeVoxelGrid(*ct, ct->GetBufferedRegion());
  }
  const Eigen::Matrix3d toIndex = grid.axes.inverse();
  std::ostringstream    text;
  text.precision(9);
  text << "distance,x,y,z,density,gradient_x,gradient_y,gradient_z" << (ct.IsNull() ? "" : ",ct") << '\n';
  for (const DensityProfilePoint & p : profile)
  {
    text << p.distance << ',' << p.point.x() << ',' << p.point.y() << ',' << p.point.z();
    for (const double value : { p.value, p.gradient.x(), p.gradient.y(), p.gradient.z() })
    {
      text << ',';
      if (p.cell >= 0)
      {
        text << value;
      }
    }
    if (ct.IsNotNull())
    {
      text << ',' << LinearSampler<float>(ct->GetBufferPointer(), grid.size)(toIndex * (p.point - grid.origin));
    }
    text << '\n';
  }
  AtomicFile file(options.output);
  file.Write(text.str());
  file.Commit();
}
} // namespace

void
AddVoxelsCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<VoxelsOptions>();
  auto * command = app.add_subcommand("voxels", "Sample a density model onto an image grid");
  command->add_option("mesh", options->mesh, "Density mesh (.vtu)")->required();
  auto * like = command->add_option("--like", options->like, "Image whose grid is taken");
  command->add_option("--spacing", options->spacing, "Voxel size in mm of a grid around the model; default 1")
    ->check(Length())
    ->excludes(like);
  AddParameterOptions(command, options->image);
  command->add_option("-o,--output", options->output, "Image to write (.nii.gz, .mha, .nrrd, ...)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunVoxels(*options, session); }; });
}

void
AddProfileCommand(CLI::App & app, Action & action)
{
  auto   options = std::make_shared<ProfileOptions>();
  auto * command = app.add_subcommand("profile", "Density and its gradient along a line, beside the CT's");
  command->add_option("mesh", options->mesh, "Density mesh (.vtu)")->required();
  command->add_option("--from", options->from, "Start of the line: x y z in mm, LPS")->required()->expected(3);
  command->add_option("--to", options->to, "Its end")->required()->expected(3);
  command->add_option("--points", options->points, "Number of places; default 201")
    ->check(CLI::Range(2, 1000000).description(""));
  command->add_option("--ct", options->ct, "CT to give beside it, linearly interpolated");
  AddSeriesOption(command, options->series);
  command->add_option("-o,--output", options->output, "Table to write (.csv)")->required();
  command->callback([options, &action] { action = [options](Session & session) { RunProfile(*options, session); }; });
}
} // namespace bone
