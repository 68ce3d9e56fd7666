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
  const Eigen::VectorXd size = NumbersMember(object, "size", 2);
  for (int k = 0; k < 2; ++k)
  {
    if (!(size[k] >= 1 && size[k] <= std::numeric_limits<int>::max()) || size[k] != std::floor(size[k]))
    {
      Refuse("'size' must be two positive whole numbers, columns and rows");
    }
    view.size[k] = static_cast<int>(size[k]);
  }
  return view;
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
      auto geometry = XRayGeometry::New();
      geometry->SetView(ToView(object));
      views.push_back(geometry);
    });
  }
  return views;
}

void
WriteGeometry(const std::vector<XRayGeometry::Pointer> & views, const std::string & path)
{
  json list = json::array();
  for (const auto & view : views)
  {
    list.push_back(FromView(view->GetView()));
  }
  WriteFileAtomically(path, (list.size() == 1 ? list.front() : list).dump(2) + '\n');
}
} // namespace bone
