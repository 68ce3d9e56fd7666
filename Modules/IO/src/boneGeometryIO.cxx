/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneGeometryIO.h"

#include "boneAtomicFile.h"
#include "boneJson.h"
#include "boneRefuse.h"

#include <limits>

namespace bone
{
namespace
{
using nlohmann::json;

/** Ten times the largest detectors and films; an image of them takes half a gigabyte. */
constexpr double MostPixels = 1.3e8;

std::array<int, 2>
SizeMember(const json & object, const char * name)
{
  const Eigen::VectorXd numbers = NumbersMember(object, name, 2);
  std::array<int, 2>    size{};
  for (int k = 0; k < 2; ++k)
  {
    if (!(numbers[k] >= 1 && numbers[k] <= std::numeric_limits<int>::max()) || numbers[k] != std::floor(numbers[k]))
    {
      Refuse("'", name, "' must be two positive whole numbers, columns and rows");
    }
    size[k] = static_cast<int>(numbers[k]);
  }
  if (numbers[0] * numbers[1] > MostPixels)
  {
    Refuse("'", name, "' asks for ", numbers[0] * numbers[1], " pixels; a detector has at most ", MostPixels);
  }
  return size;
}

XRayGeometry::View
ToView(const json & object)
{
  RequireMembersAmong(object, { "source", "direction", "detectorOrigin", "detectorU", "detectorV", "size", "spacing" });
  XRayGeometry::View view;
  view.parallel = object.contains("direction");
  if (view.parallel == object.contains("source"))
  {
    Refuse(view.parallel ? "has both 'source' and 'direction': a point source has the first, a parallel beam the second"
                         : "'source' (or, for a parallel beam, 'direction') is missing");
  }
  (view.parallel ? view.direction : view.source) = NumbersMember(object, view.parallel ? "direction" : "source", 3);
  view.detectorOrigin = NumbersMember(object, "detectorOrigin", 3);
  view.detectorU = NumbersMember(object, "detectorU", 3);
  view.detectorV = NumbersMember(object, "detectorV", 3);
  view.spacing = NumbersMember(object, "spacing", 2);
  view.size = SizeMember(object, "size");
  return view;
}

XRayGeometry::View
MatrixToView(const json & object)
{
  RequireMembersAmong(object, { "matrix", "size", "columnSpacing" });
  const json &     rows = object["matrix"];
  ProjectionMatrix matrix;
  if (!rows.is_array() || rows.size() != 3)
  {
    Refuse("'matrix' must be a list of 3 rows of 4 numbers");
  }
  for (int r = 0; r < 3; ++r)
  {
    matrix.row(r) = NumbersMember(json{ { "matrix's row", rows[r] } }, "matrix's row", 4).transpose();
  }
  return FromProjectionMatrix(matrix, SizeMember(object, "size"), NumberMember(object, "columnSpacing"));
}

XRayGeometry::View
PlastimatchToView(const json & object)
{
  RequireMembersAmong(object, { "nrm", "vup", "sad", "sid", "isocenter", "dim", "detectorSize", "imageCenter" });
  PlastimatchView view;
  view.nrm = NumbersMember(object, "nrm", 3);
  view.vup = NumbersMember(object, "vup", 3);
  view.sad = NumberMember(object, "sad");
  view.sid = NumberMember(object, "sid");
  view.isocenter = NumbersMember(object, "isocenter", 3);
  view.dim = SizeMember(object, "dim");
  view.detectorSize = NumbersMember(object, "detectorSize", 2);
  view.imageCenter = NumbersMember(object, "imageCenter", 2);
  return FromPlastimatch(view);
}

/** The views of an object; files that it names lie in `folder`. */
std::vector<XRayGeometry::View>
ToViews(const json & object, const std::string & folder)
{
  if (object.is_object() && object.contains("matrix"))
  {
    return { MatrixToView(object) };
  }
  if (object.is_object() && object.contains("nrm"))
  {
    return { PlastimatchToView(object) };
  }
  if (!object.is_object() || !object.contains("rtk"))
  {
    return { ToView(object) };
  }
  RequireMembersAmong(object, { "rtk", "size", "spacing", "origin", "rowsDown" });
  RtkGrid grid;
  grid.size = SizeMember(object, "size");
  grid.spacing = NumbersMember(object, "spacing", 2);
  grid.origin = object.contains("origin") ? Vector2(NumbersMember(object, "origin", 2)) : Vector2(0, 0);
  if (object.contains("rowsDown") && !object["rowsDown"].is_boolean())
  {
    Refuse("'rowsDown' must be true or false");
  }
  grid.rowsDown = object.value("rowsDown", false);
  const std::string               name = FileMember(object, "rtk");
  std::vector<XRayGeometry::View> views;
  try
  {
    for (const RtkProjection & projection : ReadRtkGeometry(name.front() == '/' ? name : folder + name))
    {
      views.push_back(FromRtk(projection, grid));
    }
  }
  catch (const IOError & error)
  {
    Refuse(ErrorLine(error)); // the name of the file that names it goes before it
  }
  return views;
}

json
FromView(const XRayGeometry::View & view)
{
  json object;
  object[view.parallel ? "direction" : "source"] = ToJson(view.parallel ? view.direction : view.source);
  object["detectorOrigin"] = ToJson(view.detectorOrigin);
  object["detectorU"] = ToJson(view.detectorU);
  object["detectorV"] = ToJson(view.detectorV);
  object["size"] = view.size;
  object["spacing"] = ToJson(view.spacing);
  return object;
}

json
FromView(const XRayGeometry::View & view, GeometryConvention convention)
{
  json object;
  if (convention == GeometryConvention::Matrix)
  {
    if (view.parallel)
    {
      Refuse("a parallel beam's matrix does not tell where the detector is: write the view itself");
    }
    const ProjectionMatrix matrix = ToProjectionMatrix(view);
    for (int r = 0; r < 3; ++r)
    {
      object["matrix"].push_back(ToJson(Eigen::Vector4d(matrix.row(r).transpose())));
    }
    object["size"] = view.size;
    object["columnSpacing"] = view.spacing.x();
    return object;
  }
  if (convention == GeometryConvention::Plastimatch)
  {
    const Vector3 normal = view.detectorU.cross(view.detectorV);
    const double  sad = std::abs(normal.dot(view.source));
    const auto    to = ToPlastimatch(view, sad > 0 ? sad : std::abs(normal.dot(view.detectorOrigin - view.source)));
    object["nrm"] = ToJson(to.nrm);
    object["vup"] = ToJson(to.vup);
    object["sad"] = to.sad;
    object["sid"] = to.sid;
    object["isocenter"] = ToJson(to.isocenter);
    object["dim"] = to.dim;
    object["detectorSize"] = ToJson(to.detectorSize);
    object["imageCenter"] = ToJson(to.imageCenter);
    return object;
  }
  return FromView(view);
}
} // namespace

std::vector<XRayGeometry::Pointer>
ReadGeometry(const std::string & path)
{
  const json document = ReadJsonFile(path);
  const json list = document.is_array() ? document : json::array({ document });
  if (list.empty())
  {
    throw IOError(path, "holds no view");
  }
  std::vector<XRayGeometry::Pointer> views;
  for (const json & object : list)
  {
    const std::string which = list.size() > 1 ? Say(path, ": view ", views.size() + 1) : path;
    NamingFile(which, [&] {
      for (const auto & view : ToViews(object, path.substr(0, path.find_last_of('/') + 1)))
      {
        auto geometry = XRayGeometry::New();
        geometry->SetView(view);
        views.push_back(geometry);
      }
    });
  }
  return views;
}

void
WriteGeometry(const std::vector<XRayGeometry::Pointer> & views, const std::string & path, GeometryConvention convention)
{
  json list = json::array();
  NamingFile(path, [&] {
    for (const auto & view : views)
    {
      list.push_back(FromView(view->GetView(), convention));
    }
  });
  WriteFileAtomically(path, (list.size() == 1 ? list.front() : list).dump(2) + '\n');
}
} // namespace bone
