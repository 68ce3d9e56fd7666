/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneCommands.h"
#include "boneDescribe.h"
#include "boneInputOptions.h"

#include "boneContourIO.h"
#include "boneFileName.h"
#include "boneGeometryIO.h"
#include "boneHierarchyIO.h"
#include "boneIOError.h"
#include "boneMeshIO.h"
#include "boneModelIO.h"

#include <filesystem>
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
} // namespace

void
AddInfoCommand(CLI::App & app, Action & action)
{
  auto   path = std::make_shared<std::string>();
  auto   series = std::make_shared<std::string>();
  auto * command = app.add_subcommand("info", "Say what is in a file, or in a folder with a DICOM series");
  command->add_option("file", *path, "Mesh, contours, hierarchy, X-ray views, statistical model, surface or image")
    ->required();
  AddSeriesOption(command, *series);
  command->callback([path, series, &action] {
    action = [path, series](Session & session) { session.Print(Describe(*path, *series, session)); };
  });
}
} // namespace bone
