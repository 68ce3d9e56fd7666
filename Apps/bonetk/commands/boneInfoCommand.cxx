/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneDescribe.h"
#include "boneInputOptions.h"
#include "boneParameterOptions.h"

#include "boneBuildCost.h"
#include "boneContourIO.h"
#include "boneFileName.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneIOError.h"
#include "boneLabelCrop.h"
#include "boneMeshIO.h"
#include "boneModelIO.h"

#include <itkMultiThreaderBase.h>

#include <cmath>
#include <filesystem>
#include <numeric>
#include <sstream>

namespace bone
{
namespace
{
std::string
DescribeSurface(const TriangleSurface & surface)
{
  double volume = 0.0;
  for (const auto & triangle : surface.triangles)
  {
    const Vector3 & a = surface.points[triangle[0]];
    volume += a.dot(surface.points[triangle[1]].cross(surface.points[triangle[2]])) / 6.0;
  }
  std::ostringstream os;
  os << "kind                        closed surface\npoints                      " << surface.points.size()
     << "\ntriangles                   " << surface.triangles.size() << "\nvolume (mm^3)               " << volume
     << '\n';
  return os.str();
}

/** A .vtp holds contours or a surface: what cannot be read as the one may be the other. */
std::string
DescribePolyData(const std::string & path)
{
  try
  {
    return DescribeContours(*ReadContours(path));
  }
  catch (const IOError & contours)
  {
    try
    {
      return DescribeSurface(ReadTriangleSurface(path));
    }
    catch (const IOError &)
    {
      throw contours;
    }
  }
}

std::string
Describe(const std::string & path, const std::string & series, Session & session)
{
  if (HasExtension(path, ".vtu"))
  {
    return DescribeMesh(ReadMeshArrays(path));
  }
  if (HasExtension(path, ".h5"))
  {
    return DescribeModel(*ReadStatisticalModel(path));
  }
  if (HasExtension(path, ".hierarchy.json"))
  {
    return DescribeHierarchy(*ReadHierarchy(path));
  }
  if (HasExtension(path, ".mrk.json"))
  {
    return DescribeContours(*ReadContours(path));
  }
  if (HasExtension(path, ".json"))
  {
    std::string text;
    for (const auto & view : ReadGeometry(path))
    {
      text += DescribeView(*view);
    }
    return text;
  }
  if (HasExtension(path, ".vtp"))
  {
    return DescribePolyData(path);
  }
  if (HasExtension(path, ".ply") || HasExtension(path, ".stl"))
  {
    return DescribeSurface(ReadTriangleSurface(path));
  }
  if (HasExtension(path, ".seg.nrrd"))
  {
    return DescribeLabelFile(ReadLabelFile(path));
  }
  try
  {
    return DescribeImage(*ReadChosenCT(path, series, session), ReadLabelNames(path));
  }
  catch (const IOError & volume)
  {
    // A radiograph is an image of one slice, which is no CT.
    try
    {
      return DescribeImage(*ReadRadiograph(path), {});
    }
    catch (const IOError &)
    {
      throw volume;
    }
  }
}

/** What of a build is said before it is made. */
struct CostOptions
{
  bool            wanted{ false };
  LabelOptions    labels;
  BuildParameters parameters;
};

double
CountVoxels(const CTImage::SizeType & size)
{
  return static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]);
}

/** Of each bone's box in the label map, with its margin. */
std::vector<double>
CountVoxelsOfBones(const CostOptions & options, Session & session)
{
  std::vector<double> voxels;
  for (const LabelledBone & bone : ReadBoneLabels(options.labels, nullptr, session, true))
  {
    // Where the label map is read by regions, its voxels are not there, but the box is known.
    const auto region =
      bone.region.GetNumberOfPixels() > 0 ? bone.region : MeasureLabel(bone.labels, bone.label).region;
    const auto grown = GrowRegion(bone.labels, region, options.parameters.plan.cropMargin);
    voxels.push_back(CountVoxels(grown.GetSize()));
  }
  return voxels;
}

std::string
DescribeCost(const std::string & path, const std::string & series, const CostOptions & options, Session & session)
{
  BuildSize size;
  size.voxels = CountVoxels(ReadVolumeSize(path, series));
  size.bones = options.labels.file.empty() ? std::vector<double>{ size.voxels } : CountVoxelsOfBones(options, session);
  size.threads = itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads();
  const BuildCost    cost = EstimateCost(size, options.parameters);
  std::ostringstream os;
  os << "kind                        build of " << path << "\nvoxels                      " << std::llround(size.voxels)
     << "\nbones                       " << size.bones.size() << "\nvoxels of their boxes       "
     << std::llround(std::accumulate(size.bones.begin(), size.bones.end(), 0.0)) << "\ntetrahedra of each          "
     << options.parameters.plan.tetrahedra << "\nthreads                     " << size.threads
     << "\nseconds, about              " << std::llround(std::ceil(cost.seconds)) << "\nmemory, about (MB)          "
     << std::llround(std::ceil(cost.megabytes)) << '\n';
  return os.str();
}

void
AddCostOptions(CLI::App * command, CostOptions & options)
{
  auto * cost = command->add_flag(
    "--cost", options.wanted, "Of a CT, by its header: how many seconds and how much memory its build takes, about");
  options.labels.AddTo(command, "Label map of the build, for --cost; default: the bone fills the CT", true)
    ->needs(cost);
  AddParameterOptions(command, options.parameters.plan, { "tetrahedra" });
  AddParameterOptions(command, options.parameters.fit, { "degree" });
  for (const char * name : { "--tetrahedra", "--degree" })
  {
    command->get_option(name)->needs(cost);
  }
}
} // namespace

void
AddInfoCommand(CLI::App & app, Action & action)
{
  auto   path = std::make_shared<std::string>();
  auto   series = std::make_shared<std::string>();
  auto   cost = std::make_shared<CostOptions>();
  auto * command = app.add_subcommand("info", "Say what is in a file, or in a folder with a DICOM series");
  command->add_option("file", *path, "Mesh, contours, hierarchy, X-ray views, statistical model, surface or image")
    ->required();
  AddSeriesOption(command, *series);
  AddCostOptions(command, *cost);
  command->callback([path, series, cost, &action] {
    action = [path, series, cost](Session & session) {
      session.Print(cost->wanted ? DescribeCost(*path, *series, *cost, session) : Describe(*path, *series, session));
    };
  });
}
} // namespace bone
